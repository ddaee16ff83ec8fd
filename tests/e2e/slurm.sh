#!/usr/bin/env bash
# A store that an array of jobs has warmed (docs/guide/scaling.md), by a real Slurm of one node: each job has a server of its own and
# asks for its part; then a new server finds every tile there. An array of jobs also bakes objects, each its share.
#   slurm.sh BIN_FOLDER
set -euo pipefail
bin="$1"
PATH="$PATH:/usr/sbin"
for program in slurmctld slurmd munged sbatch redis-server; do
  command -v $program > /dev/null || { echo "skipped: $program is not installed"; exit 0; }
done
[ "$(id -u)" -eq 0 ] || { echo "skipped: only root starts a Slurm of its own"; exit 0; }
work="$(mktemp -d)"
host="$(hostname -s)"
# Three ports that are likely free.
base=$((20000 + $$ % 10000))
finish() {
  for file in "$work"/{slurmd,slurmctld,munge/munged,redis}.pid; do [ ! -s "$file" ] || kill "$(cat "$file")" 2> /dev/null || true; done
  sleep .5
  rm -rf "$work"
}
trap finish EXIT
mkdir -p "$work"/{munge,state,spool}
chmod 700 "$work/munge"
head -c 1024 /dev/urandom > "$work/munge/key"
chmod 400 "$work/munge/key"
munged --force --key-file="$work/munge/key" --socket="$work/munge/socket" --pid-file="$work/munge/munged.pid" --log-file="$work/munge/log" --seed-file="$work/munge/seed" ||
  { echo "skipped: munge does not start here"; exit 0; }
cat > "$work/slurm.conf" << CONF
ClusterName=mirage
SlurmctldHost=$host(127.0.0.1)
AuthType=auth/munge
CryptoType=crypto/munge
AuthInfo=socket=$work/munge/socket
SlurmUser=root
SlurmdUser=root
SlurmctldPort=$base
SlurmdPort=$((base + 1))
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF="$work/slurm.conf"
slurmctld && slurmd -N "$host" || { echo "skipped: Slurm does not start here"; exit 0; }
for _ in $(seq 100); do ! sinfo -h -o %T 2> /dev/null | grep -q idle || break; sleep .1; done
sinfo -h -o %T | grep -q idle || { cat "$work"/slurm*.log; echo "skipped: Slurm does not start here"; exit 0; }
redis-server --port $((base + 2)) --bind 127.0.0.1 --save '' --daemonize yes --pidfile "$work/redis.pid" --dir "$work" > /dev/null
store="redis://127.0.0.1:$((base + 2))"
scene='builtin:clutter?objects=60'
walk="--path builtin:walk --clients 10 --duration 5 --rate 4 --spread 10"
cat > "$work/job" << JOB
#!/bin/bash
#SBATCH --array=0-3
#SBATCH --output=$work/out-%a
port=$work/port-\$SLURM_ARRAY_TASK_ID
"$bin/mirage-server" '$scene' --listen 127.0.0.1:0 --port-file \$port --store $store &
until [ -s \$port ]; do sleep .1; done
"$bin/mirage-load" ws://127.0.0.1:\$(cat \$port) $walk --warm-shard \$SLURM_ARRAY_TASK_ID/\$SLURM_ARRAY_TASK_COUNT
status=\$?
kill %1; wait
exit \$status
JOB
kept_tiles() { redis-cli -p $((base + 2)) --scan --pattern 'mirage:tile:*' | wc -l; }
sbatch --wait "$work/job" > /dev/null || { cat "$work"/out-*; exit 1; }
kept="$(kept_tiles)"
"$bin/mirage-server" "$scene" --listen 127.0.0.1:0 --port-file "$work/port" --store "$store" > "$work/server.log" 2>&1 &
until [ -s "$work/port" ]; do sleep .1; done
# shellcheck disable=SC2086
"$bin/mirage-load" "ws://127.0.0.1:$(cat "$work/port")" $walk --urls "$work/urls" > "$work/load.txt" 2> "$work/load.log"
kill %1
wait
tiles="$(wc -l < "$work/urls")"
warmed="$(awk '/^warmed/ { n += $2 } END { print n + 0 }' "$work"/out-*)"
rendered="$(awk '/^server/ { print $2 }' "$work/load.txt")"
added="$(($(kept_tiles) - kept))"
echo "$tiles tiles; warmed by 4 jobs: $warmed; kept: $kept; a new server added $added and rendered $rendered"
# Shares of a bake (docs/guide/baking.md) make the bytes of one run.
bake=("$bin/mirage-bake" builtin:clutter --object '*lamp*' --object 'book*' --grid 4 --size 128 --measure none --out)
{
  printf '#!/bin/bash\n#SBATCH --array=1-4\n#SBATCH --output=%s/bake-%%a\n' "$work"
  printf '%q ' "${bake[@]}" "$work/shares"
  printf -- '--shard $SLURM_ARRAY_TASK_ID/4\n'
} > "$work/bake-job"
sbatch --wait "$work/bake-job" > /dev/null || { cat "$work"/bake-*; exit 1; }
"${bake[@]}" "$work/one" 2> /dev/null
diff -r --exclude='.*' "$work/one" "$work/shares"
# A store that takes longer than 10 ms, as on a machine with too much to do, is done without for a while: what is rendered
# meanwhile is kept under the names that are there already, so nothing that was warmed by name is missing where none is added.
[ "$tiles" -gt 20 ] && [ "$warmed" -eq "$tiles" ] && [ "$kept" -ge "$tiles" ] && [ "$added" -eq 0 ] && [ "$rendered" -lt $((tiles / 2)) ]
