#!/usr/bin/env bash
# The Debian packages in a root of their own: installed, the service's command run as its user, a program built against the
# library, upgraded with a configuration that somebody has changed, purged. What stays is what is a user's. Needs root,
# mmdebstrap and a mirror; downloads some 300 MB.
#   package_root.sh FOLDER_OF_PACKAGES
set -euo pipefail
packages="$(cd "$1" && pwd)"
source="$(cd "$(dirname "$0")/../.." && pwd)"
work="$(mktemp -d)"
root="$work/root"
fail() { echo "package_root: $*"; exit 1; }
umount_all() { for at in dev proc; do umount -l "$root/$at" 2> /dev/null || true; done; }
trap 'umount_all; rm -rf "$work"' EXIT
mmdebstrap --variant=minbase --include=ca-certificates bookworm "$root" > "$work/log" 2>&1 || { tail "$work/log"; exit 1; }
mount --bind /dev "$root/dev"
mount -t proc proc "$root/proc"
cp "$packages"/*.deb "$root/root/"
rm -f "$root"/root/*dbgsym*
cp /etc/resolv.conf "$root/etc/resolv.conf"
printf '#!/bin/sh\nexit 101\n' > "$root/usr/sbin/policy-rc.d"  # no service runs in here
chmod +x "$root/usr/sbin/policy-rc.d"
inside() { DEBIAN_FRONTEND=noninteractive LC_ALL=C chroot "$root" "$@"; }
files() { (cd "$root" && find . -xdev \( -path ./proc -o -path ./dev -o -path ./tmp -o -path ./var/lib/apt -o -path ./var/cache/apt \
  -o -path ./var/lib/dpkg -o -path ./var/log -o -path ./var/cache/ldconfig -o -path ./root \) -prune -o -print | sort); }
dependencies="$(for deb in "$root"/root/*.deb; do dpkg-deb -f "$deb" Depends; done | tr ',' '\n' | sed 's/(.*//; s/|.*//' | tr -d ' ' | grep -v mirage | sort -u)"
inside apt-get update -q > "$work/log" 2>&1 || { tail "$work/log"; exit 1; }
inside apt-get install -y -q --no-install-recommends $dependencies gcc libc6-dev pkg-config libglfw3-dev > "$work/log" 2>&1 || { tail "$work/log"; exit 1; }
files > "$work/before"

inside sh -c 'apt-get install -y -q --no-install-recommends /root/*.deb' > "$work/log" 2>&1 || { tail -30 "$work/log"; exit 1; }
inside getent passwd _mirage > /dev/null || fail "there is no user _mirage"
inside mirage-server --config /etc/mirage/server.toml --check-config > "$work/log" 2>&1 || { cat "$work/log"; fail "the configuration is wrong"; }
inside install -d -o _mirage -g _mirage /var/cache/mirage  # the service manager makes it
command="$(sed -n 's/^ExecStart=//p' "$root/usr/lib/systemd/system/mirage-server.service")"
user="$(sed -n 's/^User=//p' "$root/usr/lib/systemd/system/mirage-server.service")"
inside setpriv --reuid "$user" --regid "$user" --clear-groups timeout 60 $command > "$work/server" 2>&1 &
for _ in $(seq 300); do grep -q '^ready' "$work/server" && break; sleep 0.2; done
grep -q '^ready' "$work/server" || { cat "$work/server"; fail "the service's command is not ready"; }
inside mirage-view ws://127.0.0.1:9870 --offscreen 160x90 --frames 40 > "$work/view" 2>&1 || { cat "$work/view"; fail "the viewer fails"; }
wait || true
inside sh -c 'cc -std=c99 /usr/share/doc/libmirage-client-dev/examples/embed/*.c -o /tmp/embed $(pkg-config --cflags --libs mirage-client glfw3) -lOpenGL -lm' ||
  fail "the example of the package does not build"

echo '# mine' >> "$root/etc/mirage/server.toml"
touch "$root/var/cache/mirage/kept"
inside sh -c 'apt-get install -y -q --reinstall -o Dpkg::Options::=--force-confold /root/*.deb' > "$work/log" 2>&1 || { tail "$work/log"; exit 1; }
grep -q '^# mine' "$root/etc/mirage/server.toml" || fail "an upgrade overwrote the user's configuration"
[ -e "$root/var/cache/mirage/kept" ] || fail "an upgrade emptied the cache"
inside apt-get purge -y -q 'mirage-*' 'libmirage-*' > "$work/log" 2>&1 || { tail "$work/log"; exit 1; }
files > "$work/after"
left="$(comm -13 "$work/before" "$work/after" | grep -vE '^\./(etc/(passwd|group|shadow|gshadow)-?|var/lib/systemd(/.*)?|etc/ld.so.cache)$' || true)"
[ -z "$left" ] || fail "left after the purge: $left"
echo "installed, served, built against, upgraded and purged"
