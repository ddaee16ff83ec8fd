#!/usr/bin/env bash
# Runs the unpacked bundle in an empty root, which has the C library, a shell and three tools, as a bare server image has. There it
# serves a scene with images, draws it, and makes a report with pictures. No X11, libdrm or GL of this machine is there.
#   bare_root.sh UNPACKED_BUNDLE
# Exit code 77: user namespaces are not allowed here.
set -euo pipefail
bundle="$(realpath "$1")"
source="$(realpath "$(dirname "$0")/../..")"
unshare --user --map-root-user --mount --pid --fork true 2> /dev/null || {
  echo "skipped: this user may not make namespaces (unshare --user)"
  exit 77
}
root="$(mktemp -d)"
trap 'rm -rf "$root"' EXIT
mkdir -p "$root"/{bin,dev,proc,tmp,models,lib64,lib/x86_64-linux-gnu,bundle}
cp -L /lib64/ld-linux-x86-64.so.2 "$root/lib64/"
for library in c m mvec dl rt pthread resolv util; do
  cp -L /lib/x86_64-linux-gnu/lib$library.so.* "$root/lib/x86_64-linux-gnu/"
done
for tool in sh sleep cat env; do
  cp -L "$(command -v $tool)" "$root/bin/"
done
cp "$source/tests/data/assets/objects/flight_helmet.glb" "$root/models/"
cat > "$root/run" << 'END'
set -eu
export PATH=/bundle/bin:/bin HOME=/tmp
mirage-server /models/flight_helmet.glb --strict --listen unix:/tmp/socket > /tmp/server.log 2>&1 &
server=$!
while [ ! -S /tmp/socket ]; do
  kill -0 $server || { cat /tmp/server.log; exit 1; }
  sleep 0.2
done
mirage-view unix:/tmp/socket --offscreen 160x90 --frames 30 --virtual-time --net rtt=20,rate=50 --stats /tmp/stats.json \
  > /tmp/view.log 2>&1 || { cat /tmp/server.log /tmp/view.log; exit 1; }
mirage-report models /models --quick --out /tmp/report > /tmp/report.log 2>&1 || { cat /tmp/report.log; exit 1; }
END
# Runs in namespaces of its own: the folders of this machine are seen by nobody inside.
unshare --user --map-root-user --mount --pid --fork --kill-child bash -euo pipefail -c '
  root="$1"
  mount --rbind "$2" "$root/bundle"
  mount -t proc proc "$root/proc"
  for node in null zero urandom; do
    touch "$root/dev/$node"
    mount --bind "/dev/$node" "$root/dev/$node"
  done
  exec chroot "$root" /bin/env -i /bin/sh /run' bash "$root" "$bundle"
grep -qE '"received": [1-9]' "$root/tmp/stats.json" || { cat "$root/tmp/view.log"; exit 1; }
grep -q 'data:image/jpeg' "$root/tmp/report/index.html" || { echo "the report has no picture"; cat "$root/tmp/report.log"; exit 1; }
