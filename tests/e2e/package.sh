#!/usr/bin/env bash
# The Debian packages: that the checker of packages finds no error, what is in them, that their programs run from where they lie,
# and that manual pages and completions name each option. tests/e2e/package_root.sh installs them in a root of their own.
#   package.sh BUILD_FOLDER
set -euo pipefail
build="$1"
source="$(cd "$(dirname "$0")/../.." && pwd)"
skip() { echo "skipped: $*"; exit 0; }
for tool in dh lintian; do command -v $tool > /dev/null || skip "$tool is not installed"; done
grep -q '^CMAKE_INSTALL_PREFIX:[A-Z]*=/usr$' "$build/CMakeCache.txt" || skip "the build is configured for another prefix than /usr"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
fail() { echo "package: $*"; exit 1; }
"$source/scripts/deb" --build "$build" --out "$work/out" > "$work/log" 2>&1 || { cat "$work/log"; exit 1; }
for package in libmirage-client0 libmirage-client-dev mirage-server mirage-viewer mirage-tools; do
  ls "$work/out/${package}_"*.deb > /dev/null || fail "there is no $package"
done
allow=()
[ "$(id -u)" -ne 0 ] || allow=(--allow-root)
errors="$(lintian "${allow[@]}" "$work"/out/*.deb 2> /dev/null | grep '^E:' || true)"
[ -z "$errors" ] || fail "$errors"

root="$work/root"
for deb in "$work"/out/*.deb; do case "$deb" in *dbgsym*) ;; *) dpkg-deb -x "$deb" "$root" ;; esac; done
multiarch="$(dpkg-architecture -qDEB_HOST_MULTIARCH)"
for file in bin/mirage-server bin/mirage-view bin/mirage-load bin/mirage-token lib/systemd/system/mirage-server.service \
    lib/sysusers.d/mirage-server.conf share/doc/mirage-server/examples/server.toml share/man/man3/libmirage-client.3.gz \
    share/man/man5/mirage-server.toml.5.gz "lib/$multiarch/libmirage-client.so.0" share/applications/mirage-view.desktop; do
  [ -s "$root/usr/$file" ] || fail "the packages lack $file"
done
[ -s "$root/etc/mirage/server.toml" ] || fail "the server lacks its configuration"
dpkg-deb -I "$work"/out/mirage-server_*.deb conffiles | grep -q '^/etc/mirage/server.toml' || fail "server.toml is no conffile"
for module in "$build"/bin/libmirage_*.so; do
  [ -s "$root/usr/lib/mirage/${module##*/}" ] || fail "the packages lack ${module##*/}"
done
# The server finds its module where the package puts it.
"$root/usr/bin/mirage-server" --strict --explain "$source/tests/data/assets/objects/flight_helmet.glb" > /dev/null
"$root/usr/bin/mirage-server" --config "$root/etc/mirage/server.toml" --cache-dir "$work/cache" --check-config > /dev/null
for program in server view load token report sheet; do
  "$root/usr/bin/mirage-$program" --version > /dev/null
  page="$(zcat "$root/usr/share/man/man1/mirage-$program.1.gz")"
  for option in $("$root/usr/bin/mirage-$program" --help | grep -oE '^  --[a-z-]+' | tr -d ' '); do
    grep -q -- "^\.B ${option//-/\\\\-}" <<< "$page" || fail "mirage-$program.1 does not have $option"
    grep -q -- "$option[ \")]" "$root/usr/share/bash-completion/completions/mirage-$program" || fail "bash does not complete $option"
    grep -q -- "'$option\[" "$root/usr/share/zsh/vendor-completions/_mirage-$program" || fail "zsh does not complete $option"
    grep -q -- "-l ${option#--} " "$root/usr/share/fish/vendor_completions.d/mirage-$program.fish" || fail "fish does not complete $option"
  done
done
bash -n "$root"/usr/share/bash-completion/completions/*
depends="$(dpkg-deb -f "$work"/out/mirage-server_*.deb Depends)"
for library in libwebsockets libhiredis libopenimageio libegl1 libgl1-mesa-dri; do
  case "$depends" in *"$library"*) ;; *) fail "mirage-server does not depend on $library" ;; esac
done
du -ch "$work"/out/*.deb | tail -1
