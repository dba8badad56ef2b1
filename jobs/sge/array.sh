#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# UNTESTED: an array of equal tasks, which share the cases, under Sun or Altair Grid Engine, written after its manual.
# Change what is in capitals, then: qsub jobs/sge/array.sh
# Afterwards: qsub -hold_jid shearwake -b y "build/shearwake reduce out/NAME && build/shearwake report out/NAME"
#$ -N shearwake
#$ -t 1-40
#$ -tc 10
#$ -pe mpi 16
#$ -l h_rt=1:00:00
#$ -cwd
#$ -j y
# Sends SIGUSR2 before the end; -r y starts a task again after the loss of its host, and after exit code 99.
#$ -notify
#$ -r y
export HWLOC_COMPONENTS="${HWLOC_COMPONENTS--opencl}" # mpirun forwards signals: docs/how-to/cluster.md
mpirun -n "$NSLOTS" build/shearwake run JOB.toml --out out/NAME --walltime 58:00 &
step=$!
trap 'kill -s USR2 "$step"' USR2 TERM
while kill -0 "$step" 2>/dev/null; do
    wait "$step"
done
wait "$step"
code=$?
[ "$code" -ne 75 ] || [ -e out/NAME/STOP ] || exit 99
exit "$code"
