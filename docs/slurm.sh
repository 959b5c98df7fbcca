#!/bin/sh
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:INT@60
# A task of a benchmark as a task of a job array of Slurm: sbatch --array=0-14 docs/slurm.sh RUN [OPTIONS]
# The variables of sbatch (SBATCH_SIGNAL, ...) override the lines above.
warned=
program=
# Slurm warns of the time limit by SIGINT, to this shell alone. When the job is cancelled or preempted, it sends SIGTERM
# to every process of the job, also to the program.
trap 'warned=yes; [ -z "$program" ] || kill -TERM "$program"' INT
trap : TERM
out=$1
shift
"${DDL:-ddl}" benchmark --out "$out" --task "$SLURM_ARRAY_TASK_ID" "$@" &
program=$!
[ -z "$warned" ] || kill -TERM "$program"
# A signal ends `wait` before the program has ended.
while wait "$program"; code=$?; kill -0 "$program" 2>/dev/null; do :; done
if [ -z "$warned" ] || [ "$code" -ne 130 ]; then
    exit "$code"
fi
# The program has saved its state.
if [ "${SLURM_RESTART_COUNT:-0}" -ge 100 ]; then
    echo "The time limit is too short: the task was queued again 100 times. Allow more, as with SBATCH_TIMELIMIT=4:00:00." >&2
    exit 1
fi
scontrol requeue "$SLURM_JOB_ID"
