#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# UNTESTED: one allocation for the whole sweep under PBS Pro or OpenPBS, written after its manual.
# Change what is in capitals, then: qsub jobs/pbs/single.sh
#PBS -N shearwake
#PBS -l select=2:ncpus=64:mpiprocs=64
#PBS -l walltime=4:00:00
#PBS -j oe
#PBS -r y
cd "$PBS_O_WORKDIR" || exit 6
job=JOB.toml
out=out/NAME

# The limit above, less what the start has taken; PBS does not report it.
export HWLOC_COMPONENTS="${HWLOC_COMPONENTS--opencl}" # mpirun forwards SIGUSR1: docs/how-to/cluster.md
mpirun build/shearwake run "$job" --out "$out" --walltime 3:58:00 &
step=$!
trap 'kill -s USR1 "$step"' USR1 TERM # qsig -s SIGUSR1, qdel
while kill -0 "$step" 2>/dev/null; do
    wait "$step"
done
wait "$step"
code=$?
# Stopped early: once more. qrerun needs -r y.
if [ "$code" -eq 75 ] && [ ! -e "$out/STOP" ]; then
    qrerun "$PBS_JOBID" && sleep 60
fi
exit "$code"
