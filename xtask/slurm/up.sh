#!/usr/bin/env bash
# up.sh DIR: starts a Slurm cluster of two nodes on the loopback address of this machine, for tests. It needs root and
# Debian's slurmctld, slurmd, slurm-client and munge, and writes only to DIR. Afterwards, `. DIR/env` sets the environment
# in which Slurm's commands find the cluster, and down.sh DIR ends the cluster.
set -euo pipefail
dir=$(mkdir -p "$1" && cd "$1" && pwd)
port=${PORT:-17317}
host=$(hostname -s)

# Slurm's daemons bind to the address of the host name. It must be the loopback address, so they get their own /etc/hosts.
printf '127.0.0.1 %s\n%s\n' "$host" "$(cat /etc/hosts)" > "$dir/hosts"
export HOSTS=$dir/hosts
mkdir -p "$dir"/{log,state}
chmod 755 "$dir" "$dir/log"
install -d -o munge -g munge -m 755 "$dir/munge"
(umask 077 && head -c 256 /dev/urandom > "$dir/munge/key")
chown munge:munge "$dir/munge/key"

{
    # No accounting, no cgroups and no other hosts, so that the cluster runs on a laptop or in a container.
    cat <<CONF
ClusterName=palpate
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$dir/munge/socket,cred_expire=5
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/spool.%n
SlurmctldPidFile=$dir/slurmctld.pid
SlurmdPidFile=$dir/slurmd.%n.pid
SlurmctldLogFile=$dir/log/slurmctld
SlurmdLogFile=$dir/log/slurmd.%n
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_interval=2
SlurmdParameters=config_overrides
SlurmdTimeout=15
KillWait=5
MinJobAge=600
ReturnToService=2
CONF
    for node in 1 2; do
        echo "NodeName=n$node NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + node)) CPUs=2 RealMemory=2048"
    done
    echo "PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP"
} > "$dir/slurm.conf"
echo "export SLURM_CONF=$dir/slurm.conf" > "$dir/env"
. "$dir/env"

: > "$dir/pids"
start() {
    unshare --mount sh -c 'mount --bind "$HOSTS" /etc/hosts && exec "$0" "$@"' "$@" \
        < /dev/null > "$dir/log/${1##*/}.$(wc -l < "$dir/pids").out" 2>&1 &
    echo $! >> "$dir/pids"
}
start setpriv --reuid=munge --regid=munge --clear-groups munged --foreground --socket="$dir/munge/socket" \
    --key-file="$dir/munge/key" --pid-file="$dir/munge/pid" --seed-file="$dir/munge/seed"
for _ in $(seq 50); do [[ ! -S "$dir/munge/socket" ]] || break; sleep 0.1; done
start slurmctld -D -f "$SLURM_CONF"
for node in 1 2; do start slurmd -D -N "n$node" -f "$SLURM_CONF"; done
for _ in $(seq 100); do
    idle=$(timeout 5 sinfo -h -N -o %T 2> /dev/null | grep -c '^idle$' || true)
    [[ $idle != 2 ]] || exit 0
    sleep 0.2
done
echo "the cluster did not come up" >&2
tail -n 15 "$dir"/log/* >&2
exit 1
