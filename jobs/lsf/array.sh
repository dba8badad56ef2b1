#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# UNTESTED: an array of equal tasks, which share the cases, under IBM Spectrum LSF, written after its manual.
# Change what is in capitals, then: bsub <jobs/lsf/array.sh
# Afterwards: bsub -w 'ended("shearwake")' "build/shearwake reduce out/NAME && build/shearwake report out/NAME"
#BSUB -J "shearwake[1-40]%10"
#BSUB -n 16
#BSUB -W 1:00
#BSUB -o shearwake-%J-%I.log
# Warns the ranks two minutes before the limit; starts a task again after exit code 75 and after the loss of its host.
#BSUB -wa USR2
#BSUB -wt 2
#BSUB -Q 75
#BSUB -r
export HWLOC_COMPONENTS="${HWLOC_COMPONENTS--opencl}" # mpirun forwards signals: docs/how-to/cluster.md
mpirun build/shearwake run JOB.toml --out out/NAME --walltime 58:00 &
step=$!
trap 'kill -s USR2 "$step"' USR2 TERM
while kill -0 "$step" 2>/dev/null; do
    wait "$step"
done
wait "$step"
code=$?
[ "$code" -ne 75 ] || [ ! -e out/NAME/STOP ] || code=4
exit "$code"
