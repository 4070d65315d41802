#!/bin/bash
# Tries campaign.sbatch on a Slurm of its own: one node, this machine, for a minute.
#
#   benchmarks/slurm/try_slurm.sh [LCPBENCH]        the command; build/release/lcpbench if not given
#
# A campaign in three shards must give what the undivided one gives, times apart; also where one task is requeued and
# another one cancelled midway. munged, slurmctld and slurmd are started without systemd, with configuration, key, ports
# and state in a temporary folder. They and the folder are gone at the end, however it comes.
# Missing packages are installed (cmake/packages/packages-slurm.txt), which needs root; else any user will do.
#
# Exit status: 0 if all is as expected; 1 if not; 2 for a mistake; 77 with --no-install where Slurm is missing.
set -euo pipefail
cd "$(dirname "$0")/../.."
source_folder=$PWD
most_seconds=280  # 30 are needed on a quiet machine

failure=
fail() {
  failure="try_slurm.sh: $1"
  echo "$failure" >&2
  exit "${2:-1}"
}
say() { echo "== $*"; }

install=yes
if [ "${1:-}" = --no-install ]; then
  install=no
  shift
fi
[ $# -le 1 ] || fail "expected at most one argument, the lcpbench command" 2
lcpbench=$(realpath -m "${1:-build/release/lcpbench}")
[ -x "$lcpbench" ] || fail "$lcpbench: expected the lcpbench command; make build makes it" 2
python=${LCPBENCH_PYTHON:-/usr/bin/python3}

PATH=$PATH:/usr/sbin
missing=
for program in munged mungekey slurmctld slurmd sbatch squeue scontrol scancel; do
  command -v "$program" > /dev/null || missing="$missing $program"
done
if [ -n "$missing" ]; then
  [ $install = yes ] || fail "not installed:$missing" 77
  sh cmake/install_packages.sh cmake/packages/packages-slurm.txt
fi

work=$(mktemp -d "${TMPDIR:-/tmp}/lcpbench-slurm.XXXXXX")
daemons=()

# What runs with a file or its folder in ours, or is told of one: Slurm detaches the processes of jobs.
processes_of_work() {
  local entry pid
  for entry in /proc/[0-9]*; do
    pid=${entry#/proc/}
    [ "$pid" != $$ ] && [ "$pid" != "$BASHPID" ] || continue
    if { readlink "$entry/cwd" "$entry"/fd/* || true; tr '\0' '\n' < "$entry/cmdline" || true; } 2> /dev/null |
      grep -qF -- "$work/"; then
      echo "$pid"
    fi
  done
}

clean_up() {
  local status=$? deadline pid
  trap '' INT TERM HUP
  trap - EXIT
  set +e
  if [ $status -ne 0 ]; then
    for log in "$work"/*.log "$work"/*/*.log; do
      [ ! -s "$log" ] || { echo "---- the end of $log"; tail -n 25 "$log"; } >&2
    done
    echo "$failure" >&2  # again: it is what the logs are to explain
  fi
  if timeout 3 scontrol ping 2> /dev/null | grep -q "is UP"; then  # Ctrl-C ends the controller too
    timeout 10 scancel --quiet --user="$(id -un)" 2> /dev/null
    deadline=$((SECONDS + 10))
    while [ $SECONDS -lt $deadline ] && [ -n "$(timeout 5 squeue -h 2> /dev/null)" ]; do sleep 0.2; done
  fi
  # The controller first, munged last: the others ask it.
  for pid in $(printf '%s\n' "${daemons[@]}" | tac); do
    kill -TERM "$pid" 2> /dev/null
    deadline=$((SECONDS + 10))
    while [ $SECONDS -lt $deadline ] && kill -0 "$pid" 2> /dev/null; do sleep 0.1; done
    kill -KILL "$pid" 2> /dev/null
    wait "$pid" 2> /dev/null
  done
  for pid in $(processes_of_work); do kill -KILL "$pid" 2> /dev/null; done
  rm -rf "$work"
  exit $status
}
trap clean_up EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
trap 'exit 129' HUP

# wait_for WHAT COMMAND...: until the command succeeds. The script ends by itself in time: who killed it from outside
# would leave the daemons.
wait_for() {
  local what=$1
  shift
  until "$@"; do
    [ $SECONDS -lt $most_seconds ] || fail "gave up waiting for $what"
    sleep 0.1
  done
}

# ---- the cluster

user=$(id -un)
host=$(hostname -s)
read -r controller_port node_port < <("$python" - << 'EOF'
import socket
sockets = [socket.socket() for _ in range(2)]
for s in sockets:
    s.bind(("127.0.0.1", 0))
print(*(s.getsockname()[1] for s in sockets))
EOF
)
chmod 755 "$work"  # clients reach munged's socket through it
mkdir -m 755 "$work/state" "$work/spool" "$work/munge" "$work/jobs"
cat > "$work/slurm.conf" << EOF
ClusterName=lcpbench-try
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$controller_port
SlurmdPort=$node_port
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
# A requeued job starts again when its credential has expired.
AuthInfo=socket=$work/munge/socket,cred_expire=5
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
MailProg=/bin/true
SchedulerType=sched/builtin
SchedulerParameters=sched_interval=1,batch_sched_delay=0
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
# Two tasks at a time, whatever this machine has.
SlurmdParameters=config_overrides
NodeName=$host NodeHostname=$host NodeAddr=127.0.0.1 CPUs=2 RealMemory=32768
PartitionName=all Nodes=$host Default=YES MaxTime=10 State=UP
KillWait=10
EOF
export SLURM_CONF=$work/slurm.conf

mungekey --create --keyfile="$work/munge/key"
# In the foreground: their processes are ours to end.
munged --foreground --key-file="$work/munge/key" --socket="$work/munge/socket" --pid-file="$work/munge/pid" \
  --log-file="$work/munge.log" --seed-file="$work/munge/seed" > "$work/munged.out.log" 2>&1 &
daemons+=($!)
wait_for "munged" test -S "$work/munge/socket"
slurmctld -D -f "$SLURM_CONF" > "$work/slurmctld.out.log" 2>&1 &
daemons+=($!)
slurmd -D -f "$SLURM_CONF" -N "$host" > "$work/slurmd.out.log" 2>&1 &
daemons+=($!)
node_is_idle() { [ "$(sinfo -h -o %T 2> /dev/null)" = idle ]; }
wait_for "the node" node_is_idle
say "$(slurmctld -V): one node, two tasks at a time"

# ---- what both campaigns are: small, and yet long enough to be stopped midway

export LCPBENCH=$lcpbench LCPBENCH_SUITE=smoke
options=(--solvers dantzig,pgs,bpp --rounds 2 --most-rounds 2 --repetitions 5 --min-time 0.003)
script=$source_folder/benchmarks/slurm/campaign.sbatch
shards=3

# submit ARRAY: prints the job's number
submit() {
  sbatch --parsable --mem=1G --time=5 --chdir="$work" --output="$LCPBENCH_OUT-%A_%a.log" --array="$1" "$script" \
    "${options[@]}"
}
# The state of task $2 of job $1.
state_of() { scontrol -o show job "${1}_$2" 2> /dev/null | sed -n 's/.*JobState=\([A-Z]*\).*/\1/p'; }
no_job_is_left() { [ -z "$(squeue -h)" ]; }
# expect_state JOB TASK STATE
expect_state() {
  local state
  state=$(state_of "$1" "$2")
  [ "$state" = "$3" ] || fail "task $2 of job $1: expected $3, found ${state:-no such task}"
}
cells_in() { [ ! -f "$LCPBENCH_OUT/shard-$1/cells.jsonl" ] || wc -l < "$LCPBENCH_OUT/shard-$1/cells.jsonl"; }
has_begun() { [ "$(cells_in "$1" || true)" != "" ] && [ "$(cells_in "$1")" -ge "$2" ]; }
# What shard $1 has now, kept for later.
keep() { cp "$LCPBENCH_OUT/shard-$1/cells.jsonl" "$LCPBENCH_OUT/kept-$1"; }
# The shard went on: what was kept is still the beginning, and more came.
expect_went_on() {
  local kept=$LCPBENCH_OUT/kept-$1 now=$LCPBENCH_OUT/shard-$1/cells.jsonl
  cmp -s -n "$(stat -c %s "$kept")" "$kept" "$now" || fail "shard $1: lost cells that it had"
  [ "$(stat -c %s "$now")" -gt "$(stat -c %s "$kept")" ] || fail "shard $1: was stopped too late to try anything"
  echo "shard $1: stopped after $(wc -l < "$kept") lines, went on to $(wc -l < "$now")"
}
merge_and_compare() {
  "$lcpbench" merge "$LCPBENCH_OUT"/shard-* -o "$LCPBENCH_OUT/merged" > /dev/null
  "$python" report/report.py same "$LCPBENCH_OUT/merged" "$work/jobs/whole"
}

# ---- mistakes are one line and status 2

# expect_refused WORDS VARIABLE=VALUE...
expect_refused() {
  local words=$1 status=0 text
  shift
  text=$(env -u LCPBENCH_OUT "$@" bash "$script" 2>&1) || status=$?
  if [ $status -ne 2 ] || [ "$(printf '%s\n' "$text" | wc -l)" -ne 1 ] || [[ $text != *"$words"* ]]; then
    fail "expected status 2 and one line with '$words', found $status: $text"
  fi
}
out=LCPBENCH_OUT=$work/jobs/mistakes
task="SLURM_ARRAY_TASK_ID=2 SLURM_ARRAY_TASK_COUNT=3 SLURM_ARRAY_TASK_MIN=1 SLURM_ARRAY_TASK_MAX=3"
expect_refused "LCPBENCH is not set" LCPBENCH=
expect_refused "expected a program" LCPBENCH="$work/nothing"
expect_refused "LCPBENCH_OUT is not set" LCPBENCH="$lcpbench"
expect_refused "--array=1-N" "$out" SLURM_ARRAY_TASK_ID=
# shellcheck disable=SC2086  # one word per variable is meant
{
  expect_refused "not 1-N" "$out" $task SLURM_ARRAY_TASK_MIN=2 SLURM_ARRAY_TASK_MAX=4
  expect_refused "not 1-N" "$out" $task SLURM_ARRAY_TASK_COUNT=1
  expect_refused "expected one of 1 to 1" "$out" $task LCPBENCH_SHARDS=1
  expect_refused "expected a number" "$out" $task LCPBENCH_SHARDS=three
  mkdir "$work/jobs/mistakes"
  echo 4 > "$work/jobs/mistakes/shards"
  expect_refused "in 4 shards, not 3" "$out" $task
}

# ---- undisturbed

export LCPBENCH_OUT=$work/jobs/plain
job=$(submit 1-$shards)
wait_for "job $job" no_job_is_left
for task in $(seq $shards); do expect_state "$job" "$task" COMPLETED; done
say "array of $shards tasks: completed"
timeout $most_seconds "$lcpbench" run --suite $LCPBENCH_SUITE "${options[@]}" -o "$work/jobs/whole" > "$work/jobs/whole.log" 2>&1
merge_and_compare
say "merged, it is the undivided campaign"

# ---- one task requeued, another one cancelled and submitted again

export LCPBENCH_OUT=$work/jobs/disturbed
job=$(submit 1-$shards)
for task in 1 2; do wait_for "cells of shard $task" has_begun $task 20; done
scontrol requeue "${job}_1"
scancel "${job}_2"
# Both end with the cell in flight.
task_has_stopped() { [[ $(state_of "$job" "$1") =~ ^(PENDING|CANCELLED)$ ]]; }
for task in 1 2; do
  wait_for "the end of task $task" task_has_stopped $task
  keep $task
done
expect_state "$job" 2 CANCELLED
wait_for "job $job" no_job_is_left
again=$(LCPBENCH_SHARDS=$shards submit 2)
wait_for "job $again" no_job_is_left
for task in 1 3; do expect_state "$job" $task COMPLETED; done
expect_state "$again" 2 COMPLETED
grep -q "shard 1/$shards, start 1" "$LCPBENCH_OUT-${job}_1.log" || fail "task 1 was not started again"
for task in 1 2; do
  # Slurm's signal reached lcpbench itself, which had time to end.
  grep -q "interrupted; --resume goes on" "$LCPBENCH_OUT-${job}_$task.log" || fail "task $task did not end orderly"
  expect_went_on $task
done
merge_and_compare
say "requeued and cancelled midway, it is still the undivided campaign"
