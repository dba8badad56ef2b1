#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# One allocation for the whole sweep: teams of ranks share the cases. scripts/submit fills in @...@.
#SBATCH --job-name=@NAME@
#SBATCH --ntasks=@RANKS@
#SBATCH --time=@TIME@
#SBATCH --output=@LOGS@/slurm/%x-%j.log
#SBATCH --open-mode=append
#SBATCH --requeue
#SBATCH --signal=B:USR1@@WARNING@
cd @FOLDER@ || exit 6
. @ROOT@/jobs/slurm/step.sh
run_step @OUT@ @PROGRAM@ run @JOB@ --out @OUT@ @RUN_OPTIONS@
