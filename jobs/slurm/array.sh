#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# A job array of equal tasks that share the cases, @RANKS@ ranks each. scripts/submit fills in @...@.
#SBATCH --job-name=@NAME@
#SBATCH --array=1-@TASKS@
#SBATCH --ntasks=@RANKS@
#SBATCH --time=@TIME@
#SBATCH --output=@LOGS@/slurm/%x-%A-%a.log
#SBATCH --open-mode=append
#SBATCH --requeue
#SBATCH --signal=B:USR1@@WARNING@
cd @FOLDER@ || exit 6
. @ROOT@/jobs/slurm/step.sh
run_step @OUT@ @PROGRAM@ run @JOB@ --out @OUT@ @RUN_OPTIONS@
