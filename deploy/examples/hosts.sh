#!/bin/bash
# One run over several hosts: coordinator and recorder here, the layers' solvers on the hosts in turn, over TCP.
#
#   deploy/examples/hosts.sh SCENE OUT HOST...         for example: hosts.sh cup.yaml runs/cup node1 node2 node3
#
# The hosts are reached with ssh and a key; a host may be named more than once, and may be this one.
#   INTERPLY_ADDRESS  where the coordinator listens, as the hosts see it (tcp://<name of this host>:7100); port 7101, too
#   INTERPLY_BIN      folder of the programs, the same on every host (default: they are on the PATH)
#   INTERPLY_REMOTE   command that runs another on a host (ssh -n -o BatchMode=yes): called with HOST PROGRAM ARGUMENTS
# Links are not encrypted: use a network that you trust. Meshes and tools in files have the same path on each host.
# Ends with the exit code of the coordinator; Ctrl-C cancels the run.
set -euo pipefail
if [ $# -lt 3 ]; then
  sed -n '2,/^[^#]/{/^#/s/^# \{0,1\}//p}' "$0" >&2
  exit 2
fi
scene=$1 out=$2
hosts=("${@:3}")
address=${INTERPLY_ADDRESS:-tcp://$(hostname):7100}
bin=${INTERPLY_BIN:+$INTERPLY_BIN/}
read -ra remote <<<"${INTERPLY_REMOTE:-ssh -n -o BatchMode=yes}"
if ! command -v "${bin}interply-coordinator" >/dev/null; then
  echo "hosts.sh: there is no ${bin}interply-coordinator here; say in INTERPLY_BIN where the programs are" >&2
  exit 1
fi
logs=$out/logs
mkdir -p "$logs"
set -m  # a process group for each: Ctrl-C is for this script, which asks the coordinator

"${bin}interply-coordinator" --bind "$address" --scene "$scene" --run "$(basename "$out")" >"$logs/coordinator.log" 2>&1 &
coordinator=$!
trap 'kill -INT $coordinator' INT TERM HUP
until grep -q '^start ' "$logs/coordinator.log" 2>/dev/null; do  # where it listens, and what each layer needs
  if ! kill -0 $coordinator 2>/dev/null; then
    cat "$logs/coordinator.log" >&2
    wait $coordinator
  fi
  sleep 0.1
done
address=$(sed -n 's/^listening at //p' "$logs/coordinator.log")

if grep -q '^start interply-recorder ' "$logs/coordinator.log"; then
  "${bin}interply-recorder" --connect "$address" --out "$out" >"$logs/recorder.log" 2>&1 &
fi
i=0
while read -r _ program _ _ _ layer; do  # start interply-solver-metal --connect ADDRESS --layer sheet_lower
  host=${hosts[i++ % ${#hosts[@]}]}
  echo "$layer on $host"
  "${remote[@]}" "$host" "$bin$program" --connect "$address" --layer "$layer" >"$logs/$layer.log" 2>&1 </dev/null &
done < <(grep '^start interply-solver-' "$logs/coordinator.log")

tail -n +1 -F --pid=$coordinator "$logs/coordinator.log" 2>/dev/null | grep --line-buffered -v '^start ' &
code=0
wait $coordinator || code=$?
while [ $code -gt 128 ] && kill -0 $coordinator 2>/dev/null; do  # a signal has ended the wait
  code=0
  wait $coordinator || code=$?
done
wait
exit $code
