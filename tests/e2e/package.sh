#!/usr/bin/env bash
# The Debian package: what is in it, that its programs run from where they lie, and that its manual pages are no nonsense.
#   package.sh BUILD_FOLDER
set -euo pipefail
build="$1"
command -v dpkg-shlibdeps > /dev/null || { echo "skipped: dpkg-dev is not installed"; exit 0; }
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
(cd "$build" && cpack -G DEB -B "$work/out" > "$work/log" 2>&1) || { cat "$work/log"; exit 1; }
deb=("$work"/out/mirage_*.deb)
dpkg-deb -x "${deb[0]}" "$work/root"
for file in bin/mirage-server bin/mirage-view bin/mirage-load bin/mirage-token lib/systemd/system/mirage-server.service \
    lib/sysusers.d/mirage.conf share/doc/mirage/examples/server.toml share/doc/mirage/examples/haproxy/haproxy.cfg; do
  [ -s "$work/root/usr/$file" ] || { echo "the package lacks $file"; exit 1; }
done
for module in "$build"/bin/libmirage_*.so; do
  [ -s "$work/root/usr/lib/mirage/${module##*/}" ] || { echo "the package lacks ${module##*/}"; exit 1; }
done
# The server finds its module where the package puts it.
"$work/root/usr/bin/mirage-server" --strict --explain "$(dirname "$0")/../data/assets/objects/flight_helmet.glb" > /dev/null
for program in server view load token report sheet; do
  "$work/root/usr/bin/mirage-$program" --version > /dev/null
  page="$work/root/usr/share/man/man1/mirage-$program.1"
  for option in $("$work/root/usr/bin/mirage-$program" --help | grep -oE '^  --[a-z-]+' | tr -d ' '); do
    grep -q -- "^\.B ${option//-/\\\\-}" "$page" || { echo "mirage-$program.1 does not have $option"; exit 1; }
  done
done
depends="$(dpkg-deb -f "${deb[0]}" Depends)"
for library in libwebsockets libhiredis libopenimageio libegl1 libgl1-mesa-dri; do
  case "$depends" in *"$library"*) ;; *) echo "the package does not depend on $library"; exit 1 ;; esac
done
echo "$(stat -c %s "${deb[0]}") bytes"
