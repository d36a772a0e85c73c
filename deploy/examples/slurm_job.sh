#!/bin/bash
#SBATCH --job-name=interply
#SBATCH --nodes=2
#SBATCH --ntasks-per-node=4
#SBATCH --cpus-per-task=1
#SBATCH --mem-per-cpu=1G
#SBATCH --time=01:00:00
# One run over the nodes of a job: coordinator and recorder on the first, the layers' solvers on all in turn, as job steps.
# Above: five layers on two nodes are three tasks a node, and one is left for coordinator and recorder; --cpus-per-task is
# the `threads` of a layer.
#
#   sbatch deploy/examples/slurm_job.sh SCENE OUT      in the folder that holds deploy/, with the programs on the PATH
#
# SCENE and OUT are on a file system that all nodes see.
set -euo pipefail
mapfile -t nodes < <(scontrol show hostnames "$SLURM_JOB_NODELIST")
export INTERPLY_ADDRESS=${INTERPLY_ADDRESS:-tcp://${nodes[0]}:7100}
export INTERPLY_REMOTE='srun --exact --nodes=1 --ntasks=1 --nodelist'
exec "$SLURM_SUBMIT_DIR/deploy/examples/hosts.sh" "$1" "$2" "${nodes[@]}"
