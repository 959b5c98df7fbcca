#!/bin/sh
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=slurm/report_%j.log
# The report of `ddl benchmark --executor slurm`. Arguments: the working folder, the program and its arguments.
cd "$1" || exit 1
shift
exec "$@" --collect
