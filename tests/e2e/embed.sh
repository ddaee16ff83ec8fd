#!/usr/bin/env bash
# libmirage-client as others build against it: installed, then examples/embed by CMake, by pkg-config with plain cc as C99, and
# against the static library. The three must draw the same picture. Also what the libraries export.
#   embed.sh BUILD_FOLDER SOURCE_FOLDER
set -euo pipefail
build="$1"
source="$2"
work="$(mktemp -d)"
server=""
trap '[ -z "$server" ] || kill "$server" 2> /dev/null || true; rm -rf "$work"' EXIT
fail() { echo "embed: $*"; exit 1; }

cmake --install "$build" --prefix "$work/usr" --component client > "$work/log" || { cat "$work/log"; exit 1; }
mv "$work/usr" "$work/moved"  # an installation can be moved
usr="$work/moved"
lib="$(dirname "$(find "$usr" -name 'libmirage-client.so.0')")"
export PKG_CONFIG_PATH="$lib/pkgconfig"

# Both libraries have the names of the interface and no others; so has each header.
interface="$(grep -o 'mirage_[a-z_]*' "$source/client/library/mirage-client.map" | sort -u)"
shared="$(nm -D --defined-only "$lib/libmirage-client.so" | awk '$2 == "T" { sub("@.*", "", $3); print $3 }' | sort -u)"
[ "$interface" = "$shared" ] || fail "the shared library exports other names: $(diff <(echo "$interface") <(echo "$shared"))"
static="$(nm -g --defined-only "$lib/libmirage-client.a" | awk 'NF == 3 { print $3 }' | sort -u)"
[ "$interface" = "$static" ] || fail "the static library exports other names: $(diff <(echo "$interface") <(echo "$static"))"
declared="$(grep -ohE 'mirage_[a-z_]+\(' "$usr"/include/mirage/*.h | tr -d '(' | sort -u)"
for name in $interface; do grep -qx "$name" <<< "$declared" || fail "no header declares $name"; done
readelf -d "$lib/libmirage-client.so" | grep -q 'SONAME.*libmirage-client.so.0\]' || fail "the soname is not libmirage-client.so.0"

# Each header stands alone, in C99 and in C++17.
for header in "$usr"/include/mirage/*; do
  name="mirage/${header##*/}"
  echo "#include <$name>" > "$work/one.cpp"
  c++ -std=c++17 -Wall -Wextra -Wpedantic -Werror -I"$usr/include" -fsyntax-only "$work/one.cpp" || fail "$name is no C++17"
  case "$name" in *.hpp) continue ;; esac
  cp "$work/one.cpp" "$work/one.c"
  cc -std=c99 -Wall -Wextra -Wpedantic -Werror -I"$usr/include" -fsyntax-only "$work/one.c" || fail "$name is no C99"
done

example="$source/examples/embed"
strict=(-std=c99 -Wall -Wextra -Wpedantic -Werror)
read -ra flags <<< "$(pkg-config --cflags mirage-client glfw3)"
read -ra libs <<< "$(pkg-config --libs mirage-client glfw3)"
cc "${strict[@]}" "${flags[@]}" "$example"/*.c -o "$work/by_pkg_config" "${libs[@]}" -lOpenGL -lm
read -ra libs <<< "$(pkg-config --static --libs mirage-client | sed 's/-lmirage-client/-l:libmirage-client.a/')"
cc "${strict[@]}" "${flags[@]}" "$example"/*.c -o "$work/static" "${libs[@]}" -lglfw -lOpenGL -lm
readelf -d "$work/static" | grep -q 'NEEDED.*mirage' && fail "the static program needs the shared library"
cmake -S "$example" -B "$work/cmake" -DCMAKE_PREFIX_PATH="$usr" > "$work/log" || { cat "$work/log"; exit 1; }
cmake --build "$work/cmake" > "$work/log" || { cat "$work/log"; exit 1; }

command -v xvfb-run > /dev/null || { echo "built three ways; not run: xvfb-run is not installed"; exit 0; }
"$build/bin/mirage-server" builtin:knot --listen 127.0.0.1:0 > "$work/server" 2>&1 &
server=$!
for _ in $(seq 300); do grep -q '^ready' "$work/server" && break; sleep 0.1; done
url="$(grep -o 'ws://[^ ]*' "$work/server" | head -1)"
export LD_LIBRARY_PATH="$lib"
for program in by_pkg_config static cmake/embed; do
  timeout 120 xvfb-run -a "$work/$program" "$url" "$work/${program//\//_}.ppm" || fail "$program ended with $?"
done
cmp "$work/by_pkg_config.ppm" "$work/static.ppm"
cmp "$work/by_pkg_config.ppm" "$work/cmake_embed.ppm"
colors="$(tail -c +16 "$work/static.ppm" | od -An -v -tu1 -w3 | sort -u | wc -l)"
[ "$colors" -gt 200 ] || fail "the picture has $colors colours: no scene in it"
cp "$work/static.ppm" "$build/embed.ppm"
echo "three builds, one picture of $colors colours; $(stat -Lc %s "$lib/libmirage-client.so") bytes shared"
