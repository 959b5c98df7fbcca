#!/bin/sh
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:INT@60
#SBATCH --output=slurm/%A_%a.log
# One task of `ddl benchmark --executor slurm`. Arguments: the plan's index of the array's first task, the working
# folder, the program and its arguments. The variables of sbatch (SBATCH_SIGNAL, ...) override the lines above.
first=$1
cd "$2" || exit 1
shift 2
began=$(date +%s)
warned=
program=
# Slurm warns of the time limit by SIGINT, to this shell alone. When the job is cancelled or preempted, it sends SIGTERM
# to every process of the job, also to the program.
trap 'warned=yes; [ -z "$program" ] || kill -TERM "$program"' INT
trap : TERM
"$@" --task "$((first + SLURM_ARRAY_TASK_ID))" &
program=$!
[ -z "$warned" ] || kill -TERM "$program"
# A signal ends `wait` before the program has ended.
while wait "$program"; code=$?; kill -0 "$program" 2>/dev/null; do :; done
if [ -z "$warned" ] || [ "$code" -ne 130 ]; then
    exit "$code"
fi
# The program has saved its state. A job that makes no progress is not queued again for ever.
took=$(($(date +%s) - began))
times=${SLURM_RESTART_COUNT:-0}
if [ "$times" -ge 100 ] || { [ "$times" -ge 3 ] && [ "$took" -lt 60 ]; }; then
    echo "The time limit of the job is too short: it was queued again $times times and was warned after $took s." >&2
    echo "Allow more time, as with SBATCH_TIMELIMIT=4:00:00, and run the same command again." >&2
    exit 1
fi
scontrol requeue "$SLURM_JOB_ID"
