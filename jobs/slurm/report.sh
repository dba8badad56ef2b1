#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Table and figures, when all of the sweep has ended well (afterok). scripts/submit fills in @...@.
#SBATCH --job-name=@NAME@-report
#SBATCH --ntasks=1
#SBATCH --time=1:00:00
#SBATCH --output=@LOGS@/slurm/%x-%j.log
#SBATCH --dependency=afterok:@AFTER@
#SBATCH --kill-on-invalid-dep=yes
cd @FOLDER@ || exit 6
@PROGRAM@ reduce @OUT@ && @REPORT@
