# SPDX-License-Identifier: BSD-3-Clause
# Functions for the batch scripts in this folder, which source this file. Runs shearwake as a step of the job,
# passes on the signal that Slurm sends before the time limit, and requeues the job when the program exits
# with the code 75 (stopped early).

launch=${SHEARWAKE_LAUNCH:-srun --kill-on-bad-exit=1}
export HWLOC_COMPONENTS="${HWLOC_COMPONENTS--opencl}" # mpirun forwards SIGUSR1: docs/how-to/cluster.md

# forward SIGNAL: srun and mpirun pass it on to all ranks.
forward() {
    echo "$(date +%FT%T) job $SLURM_JOB_ID: SIG$1 to the ranks"
    kill -s "$1" "$step" 2>/dev/null
}

# run_step OUT COMMAND...: its exit code, after a new start was asked for where there is need.
run_step() {
    out=$1
    shift
    echo "$(date +%FT%T) job $SLURM_JOB_ID on $SLURM_JOB_NODELIST: $launch $*"
    $launch "$@" &
    step=$!
    trap 'forward USR1' USR1
    trap 'forward TERM' TERM INT
    while kill -0 "$step" 2>/dev/null; do
        wait "$step" # ends at each signal too
    done
    wait "$step"
    code=$?
    trap - USR1 TERM INT
    echo "$(date +%FT%T) job $SLURM_JOB_ID: exit code $code"
    # A job that was cancelled stops early too; it is not running any more, and stays so.
    if [ "$code" -eq 75 ] && [ ! -e "$out/STOP" ] &&
        [ "$(squeue -h -j "$SLURM_JOB_ID" -o %T)" = RUNNING ]; then
        scontrol requeue "$SLURM_JOB_ID" && sleep 60 # is ended here, and begins anew
    fi
    return "$code"
}
