# SPDX-License-Identifier: BSD-3-Clause
# A Slurm of one machine, for tests: sourced by run.sh. Debian packages slurm-wlm and munge; needs root.

# start_cluster FOLDER CORES: munged, slurmctld and slurmd with all their files in the folder.
start_cluster() {
  local folder=$1 cores=$2 name
  name=$(hostname -s)
  mkdir -p "$folder"/{state,spool,log,munge}
  chmod 755 "$folder" "$folder/munge"
  dd if=/dev/urandom of="$folder/munge/key" bs=128 count=1 status=none
  chmod 400 "$folder/munge/key"
  munged --force --foreground --key-file="$folder/munge/key" --socket="$folder/munge/socket" \
    --pid-file="$folder/munge/pid" --log-file="$folder/munge/log" --seed-file="$folder/munge/seed" >"$folder/log/munged.out" 2>&1 &
  cluster_pids=($!)
  cat >"$folder/slurm.conf" <<CONF
ClusterName=test
SlurmctldHost=$name(127.0.0.1)
SlurmUser=root
SlurmctldPort=26817
SlurmdPort=26818
AuthType=auth/munge
AuthInfo=socket=$folder/munge/socket,cred_expire=5
CryptoType=crypto/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=batch_sched_delay=0,sched_interval=2
ReturnToService=2
MinJobAge=3600
MaxArraySize=1001
JobRequeue=1
RebootProgram=/bin/true
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/log/slurmctld
SlurmdLogFile=$folder/log/slurmd
SlurmdParameters=config_overrides
NodeName=$name NodeAddr=127.0.0.1 CPUs=$cores State=UNKNOWN
PartitionName=test Nodes=$name Default=YES MaxTime=INFINITE State=UP
CONF
  export SLURM_CONF=$folder/slurm.conf
  wait_for 20 test -S "$folder/munge/socket"
  slurmctld -D >"$folder/log/slurmctld.out" 2>&1 &
  cluster_pids+=($!)
  slurmd -D >"$folder/log/slurmd.out" 2>&1 &
  cluster_pids+=($!)
  wait_for 40 node_is_up
}

node_is_up() { sinfo -h -o %T 2>/dev/null | grep -Eq 'idle|mixed|allocated'; }

# wait_for SECONDS COMMAND...: until the command succeeds; fails after that time.
wait_for() {
  local until=$((SECONDS + $1))
  shift
  until "$@"; do
    ((SECONDS < until)) || { echo "gave up waiting for: $*" >&2; return 1; }
    sleep 0.5
  done
}

# Ends what start_cluster started, and nothing else.
stop_cluster() {
  local pid
  for pid in "${cluster_pids[@]}"; do kill "$pid" 2>/dev/null || true; done
  wait "${cluster_pids[@]}" 2>/dev/null || true
}
