#!/usr/bin/env bash
# Runs a command on a GPU of its own. Waits until one of the named GPUs is free, names it to the command in
# CUDA_VISIBLE_DEVICES, and keeps it until the command has ended, also by a kill.
# usage: scripts/with_gpu.sh ID,ID,... COMMAND [ARGUMENT ...]
# A GPU is taken by a lock (flock) on its folder vip-gpu-ID beside vip-bench.lock: in $VIP_LOCK_DIR, or in the
# first of /run/lock and /tmp that every user may write to. The command gets this folder as VIP_LOCK_DIR, so
# that timed runs wait for those on their own GPU only. The lock vip-bench.lock is shared: timed runs of the
# CPU and runs here wait for each other. In a job of Slurm the GPU is the one that Slurm gave to the job.
set -euo pipefail

fail() { printf 'with_gpu.sh: error: %s\n  mend: %s\n' "$1" "$2" >&2; exit 1; }
said=
say_once() { [ -n "$said" ] || printf 'waits for %s\n' "$1" >&2; said=1; }

[ $# -ge 2 ] || fail "no GPU and command are given" "give both: scripts/with_gpu.sh 0,1 COMMAND"
gpus=$1
shift
[[ $gpus =~ ^[A-Za-z0-9-]+(,[A-Za-z0-9-]+)*$ ]] ||
  fail "'$gpus' is no list of GPUs" "name them as CUDA_VISIBLE_DEVICES does, such as 0,1"

locks=${VIP_LOCK_DIR:-}
for folder in /run/lock /tmp; do
  [ -n "$locks" ] || [ "$(stat -Lc %A "$folder" 2>/dev/null | cut -c9)" != w ] || locks=$folder
done
mend="set VIP_LOCK_DIR to a folder of this machine that all its users may write to"
[ -d "$locks" ] || fail "${locks:-/run/lock and /tmp}: no folder for locks" "$mend"

# take NAME: locks the folder of a GPU for the life of this process, unless another one holds it.
take() {
  own=$locks/vip-gpu-$1
  [ -d "$own" ] || mkdir -m 1777 "$own" 2>/dev/null || [ -d "$own" ] || fail "$own: cannot be made" "$mend"
  exec 9<"$own"
  flock -n 9
}

if [ -n "${SLURM_JOB_ID:-}" ] && [ -n "${CUDA_VISIBLE_DEVICES:-}" ]; then
  # CUDA_VISIBLE_DEVICES may count within the job, SLURM_JOB_GPUS counts on the node.
  given=${SLURM_JOB_GPUS:-$CUDA_VISIBLE_DEVICES}
  until take "${given//,/-}"; do say_once "GPU $given"; sleep 1; done
else
  while :; do
    for gpu in ${gpus//,/ }; do
      ! take "$gpu" || break 2
    done
    say_once "a free GPU of $gpus"
    sleep 0.2
  done
  export CUDA_VISIBLE_DEVICES=$gpu
fi

machine=$locks/vip-bench.lock
[ -e "$machine" ] || (umask 022 && : >>"$machine") 2>/dev/null || [ -e "$machine" ] ||
  fail "$machine: cannot be made" "$mend"
exec 8<"$machine"
flock -s -n 8 || { say_once "a timed run on this machine ($machine)"; flock -s 8; }
export VIP_LOCK_DIR=$own
exec "$@"
