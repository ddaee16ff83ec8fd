#!/usr/bin/env bash
# The bundle, unpacked somewhere else and run without the build's libraries: what the loader takes comes from the bundle, but
# for GL and the C library, and a viewer of it shows a scene of its server.
set -euo pipefail
cd "$(dirname "$0")/../.."
work="$(mktemp -d)"
trap 'kill $(jobs -p) 2> /dev/null || true; rm -rf "$work"' EXIT
scripts/bundle --level 1
for archive in build/mirage-*-linux-x86_64.tar.zst; do
  case "$archive" in *-client-*) continue ;; esac
  tar -C "$work" --zstd -xf "$archive"
done
cd "$work"/mirage-*
for program in bin/*; do
  outside="$(env -i ldd "$program" | awk '/=> \// { print $3 } /not found/ { print $1 }' | grep -vE "^$PWD/(bin/\.\./)?lib/" || true)"
  foreign="$(grep -vE '/(libc|libm|libdl|librt|libpthread|libGL|libEGL|libOpenGL|libGLX|libGLdispatch)\.so' <<< "$outside" |
    grep -vE '^$' || true)"
  # What GL itself is made of is the driver's.
  foreign="$(grep -vE '/lib(X11|Xext|xcb|Xau|Xdmcp|bsd|md)\.so' <<< "$foreign" | grep -vE '^$' || true)"
  [ -z "$foreign" ] || { echo "$program takes from outside: $foreign" >&2; exit 1; }
  env -i HOME="$work" "./$program" --help > /dev/null
done
env -i HOME="$work" bin/mirage-server builtin:knot --listen "unix:$work/socket" > "$work/server.log" 2>&1 &
for _ in $(seq 300); do
  grep -q '^ready' "$work/server.log" && break
  sleep 0.1
done
env -i HOME="$work" bin/mirage-view "unix:$work/socket" --offscreen 160x90 --frames 30 --virtual-time --net rtt=20,rate=50 \
  --out "$work/frame" --stats "$work/stats.json" > "$work/view.log" 2>&1 || { cat "$work/server.log" "$work/view.log"; exit 1; }
grep -q '"received"' "$work/stats.json"
