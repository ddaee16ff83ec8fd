#!/usr/bin/env bash
# The bundle, unpacked somewhere else and run without the build's libraries: what the loader takes comes from the bundle, but
# for what is the machine's, and a viewer of it shows a scene of its server.   bundle.sh FOLDER-OF-PROGRAMS
set -euo pipefail
work="$(mktemp -d)"
trap 'kill $(jobs -p) 2> /dev/null || true; rm -rf "$work"' EXIT
"$(dirname "$0")/../../scripts/bundle" --level 1 --bin "$1" --out "$work"
tar -C "$work" --zstd -xf "$work"/mirage-*.tar.zst
cd "$work"/mirage-*-x86_64
machine='/(ld-linux-x86-64|libc|libm|libmvec|libdl|librt|libpthread|libresolv|libanl|libnsl|libutil|libstdc\+\+|libgcc_s|libz|libzstd'
machine+='|libGL|libEGL|libOpenGL|libGLX|libGLdispatch|libglapi|libgbm|libdrm[a-z_]*|libX[a-z0-9]*|libxcb[-a-z0-9]*|libexpat|libelf|libbsd|libmd)\.so'
for program in bin/*; do
  foreign="$(env -i ldd "$program" | awk '/=> \// { print $3 } /not found/ { print $1 }' |
    grep -vE "^$PWD/(bin/\.\./)?lib/|$machine" || true)"
  [ -z "$foreign" ] || { echo "$program takes from outside: $foreign" >&2; exit 1; }
  env -i HOME="$work" "./$program" --help > /dev/null
done
[ "$(ls licences | wc -l)" -gt 10 ] || { echo "licences are missing" >&2; exit 1; }
env -i HOME="$work" bin/mirage-server builtin:knot --listen "unix:$work/socket" > "$work/server.log" 2>&1 &
for _ in $(seq 600); do
  grep -q '^ready' "$work/server.log" && break
  sleep 0.1
done
grep -q '^ready' "$work/server.log" || { cat "$work/server.log"; exit 1; }
env -i HOME="$work" bin/mirage-view "unix:$work/socket" --offscreen 160x90 --frames 30 --virtual-time --net rtt=20,rate=50 \
  --stats "$work/stats.json" > "$work/view.log" 2>&1 || { cat "$work/server.log" "$work/view.log"; exit 1; }
grep -qE '"received": [1-9]' "$work/stats.json" || { cat "$work/view.log"; exit 1; }
