#!/bin/bash
#SBATCH --job-name=interply
#SBATCH --nodes=2
#SBATCH --ntasks=7
#SBATCH --cpus-per-task=1
#SBATCH --time=01:00:00
# One run over the nodes of a job: coordinator and recorder on the first, the layers' solvers on all in turn.
# --ntasks is the number of layers and two more; --cpus-per-task their `threads`.
#
#   sbatch deploy/examples/slurm_job.sh SCENE OUT      in the folder that holds deploy/, with the programs on the PATH
#
# SCENE and OUT are on a file system that all nodes see.
set -euo pipefail
mapfile -t nodes < <(scontrol show hostnames "$SLURM_JOB_NODELIST")
export INTERPLY_ADDRESS=${INTERPLY_ADDRESS:-tcp://${nodes[0]}:7100}
export INTERPLY_REMOTE='srun --overlap --nodes=1 --ntasks=1 --nodelist'
exec "$SLURM_SUBMIT_DIR/deploy/examples/hosts.sh" "$1" "$2" "${nodes[@]}"
