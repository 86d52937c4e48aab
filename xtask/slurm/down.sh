#!/usr/bin/env bash
# down.sh DIR: ends the cluster that up.sh started. It ends first the jobs, then the daemons of Slurm, then munged.
dir=$1
export SLURM_CONF=$dir/slurm.conf
[[ -e $dir/pids ]] || exit 0
jobs=$(timeout 10 squeue -h -o %A 2> /dev/null | sort -u)
[[ -z $jobs ]] || timeout 10 scancel $jobs
for _ in $(seq 40); do
    [[ -n $(timeout 5 squeue -h -o %A 2> /dev/null) ]] || break
    sleep 0.2
done
tac "$dir/pids" | while read -r pid; do
    # The daemon may have ended, and its process number may belong to another process now. So check the name.
    case $(cat "/proc/$pid/comm" 2> /dev/null) in
        slurmd | slurmctld | munged)
            kill "$pid"
            for _ in $(seq 50); do kill -0 "$pid" 2> /dev/null || break; sleep 0.1; done
            kill -9 "$pid" 2> /dev/null
            ;;
    esac
done
rm -f "$dir/pids"
