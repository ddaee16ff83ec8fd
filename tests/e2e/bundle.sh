#!/usr/bin/env bash
# The bundle, unpacked somewhere else and run without the build's libraries: what the loader takes comes from the bundle, but
# for what is the machine's, and a viewer of it shows a scene of its server. It is left in FOLDER for bare_root.sh.
#   bundle.sh FOLDER-OF-PROGRAMS FOLDER
set -euo pipefail
programs="$(realpath "$1")"
source="$(realpath "$(dirname "$0")/../..")"
work="$(mktemp -d)"
trap 'kill $(jobs -p) 2> /dev/null || true; rm -rf "$work"' EXIT
"$source/scripts/bundle" --level 1 --bin "$programs" --out "$work"
rm -rf "$2"
mkdir "$2"
tar -C "$2" --strip-components=1 --zstd -xf "$work"/mirage-*.tar.zst
cd "$2"
machine='/(ld-linux-x86-64|libc|libm|libmvec|libdl|librt|libpthread|libresolv|libanl|libnsl|libutil|libstdc\+\+|libgcc_s|libz|libzstd'
machine+='|libGL|libEGL|libOpenGL|libGLX|libGLdispatch|libglapi|libgbm|libdrm[a-z_]*|libX[-a-z0-9]*|libxcb[-a-z0-9]*|libexpat|libelf|libbsd|libmd)\.so'
for program in libexec/* lib/libmirage_*.so; do
  foreign="$(env -i ldd "$program" | awk '/=> \// { print $3 } /not found/ { print $1 }' |
    grep -vE "^$PWD/((libexec|lib)/\.\./)?lib/|$machine" || true)"
  [ -z "$foreign" ] || { echo "$program takes from outside: $foreign" >&2; exit 1; }
done
for program in bin/*; do env -i HOME="$work" "./$program" --help > /dev/null; done
[ "$(ls licences | wc -l)" -gt 10 ] || { echo "licences are missing" >&2; exit 1; }
# Programs with their libraries; then Mesa, of which half is LLVM.
for limit in "libexec 30" "lib 80" "fallback 170"; do
  read -r folder most <<< "$limit"
  [ "$(du -sm "$folder" | cut -f1)" -le "$most" ] || { echo "$folder takes more than $most MiB; what has come in?" >&2; du -k "$folder"/* | sort -n | tail; exit 1; }
done
# What is stood in for changes nothing of what Mirage reads and writes: images of glTF and environments, the report's video. All
# of lib/, found before what the tests were linked to.
for tests in "mirage_gltf_tests GltfImage.*" "mirage_core_tests EnvironmentFiles.*" "mirage_report_tests *Video*:ReportPage.*" ; do
  read -r program filter <<< "$tests"
  LD_LIBRARY_PATH="$PWD/lib" "$programs/$program" --gtest_brief=1 --gtest_filter="$filter" > "$work/tests.log" 2>&1 &&
    grep -qE 'PASSED.* [1-9]' "$work/tests.log" || { cat "$work/tests.log"; exit 1; }
done
images="$source/tests/data/flip_reference"
env -i bin/mirage-sheet "$images/noise_reference.png" "$images/noise_test.png" "$work/sheet.png" > /dev/null
# Of formats that are left out a file is refused as it is of others, and what is broken tries none of them.
head -c 900 /dev/zero > "$work/broken.hdr"
printf '\0\0\0\030ftypheic' | cat - "$work/broken.hdr" > "$work/photo.heic"
for file in broken.hdr photo.heic; do
  code=0
  env -i HOME="$work" bin/mirage-server builtin:knot --environment "$work/$file" > "$work/refused.log" 2>&1 || code=$?
  [ "$code" -eq 3 ] && grep -q '^error scene-format' "$work/refused.log" || { echo "$file: $code" >&2; cat "$work/refused.log"; exit 1; }
done
grep -q 'left out' "$work/refused.log" || { echo "photo.heic was not refused for what it is" >&2; exit 1; }
env -i HOME="$work" bin/mirage-server "$source/tests/data/assets/objects/flight_helmet.glb" --strict --listen "unix:$work/socket" \
  > "$work/server.log" 2>&1 &
for _ in $(seq 600); do
  grep -q '^ready' "$work/server.log" && break
  sleep 0.1
done
grep -q '^ready' "$work/server.log" || { cat "$work/server.log"; exit 1; }
env -i HOME="$work" bin/mirage-view "unix:$work/socket" --offscreen 160x90 --frames 30 --virtual-time --net rtt=20,rate=50 \
  --stats "$work/stats.json" > "$work/view.log" 2>&1 || { cat "$work/server.log" "$work/view.log"; exit 1; }
grep -qE '"received": [1-9]' "$work/stats.json" || { cat "$work/view.log"; exit 1; }
