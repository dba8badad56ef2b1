# SPDX-License-Identifier: BSD-3-Clause
# Runs shearwake as a step of a Slurm job. scripts/submit copies these functions into its batch scripts.

launch=${SHEARWAKE_LAUNCH:-srun --kill-on-bad-exit=1}
export HWLOC_COMPONENTS="${HWLOC_COMPONENTS--opencl}" # mpirun forwards SIGUSR1: docs/how-to/cluster.md
id=$SLURM_JOB_ID                                      # of a task of an array: its own, not that of the array
[ -z "$SLURM_ARRAY_TASK_ID" ] || id=${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID

report() {
    echo "$(date +%FT%T) job $id: $*"
}

# forward SIGNAL: srun and mpirun pass it on to all ranks.
forward() {
    report "SIG$1 to the ranks"
    kill -s "$1" "$step" 2>/dev/null
}

# Starts the job again, unless it was cancelled. This script is then ended.
requeue() {
    [ "$(squeue -h -j "$id" -o %T)" = RUNNING ] && scontrol requeue "$id" && sleep 60
}

# has_progressed TIME: whether a case file or a checkpoint is newer than this file.
has_progressed() {
    [ -n "$(find "$out/cases" "$out/checkpoints" -name '*.h5' -newer "$1" 2>/dev/null | head -n 1)" ]
}

# run_step OUT RETRIES COMMAND...: requeues the job if the command was stopped early or, at most RETRIES times, if a
# rank was killed. Slurm itself requeues it if a node is lost, which counts as killed unless that start made progress.
# Exits with 3 after two starts without progress, and with the exit code of the command otherwise. The exit code 75
# would make some clusters requeue the job: it becomes 4.
run_step() {
    out=$1 retries=$2 start=$1/slurm/start-$id killed=$1/slurm/killed-$id
    shift 2
    if [ -e "$start" ] && [ ! -e "$start-ended" ] && ! has_progressed "$start"; then
        echo "a node was lost" >>"$killed"
        if [ "$(wc -l <"$killed")" -gt "$retries" ]; then
            report "not started: $(wc -l <"$killed") starts ended because a rank was killed or a node was lost; submit the job again to continue"
            return 4
        fi
    fi
    report "on $SLURM_JOB_NODELIST: $launch $*"
    rm -f "$start-ended"
    [ ! -e "$start" ] || mv "$start" "$start-before"
    touch "$start"
    $launch "$@" &
    step=$!
    trap 'forward USR1' USR1
    trap 'forward TERM' TERM INT
    while kill -0 "$step" 2>/dev/null; do
        wait "$step" # also ends at each signal
    done
    wait "$step"
    code=$?
    trap - USR1 TERM INT
    touch "$start-ended"
    report "exit code $code"
    if [ "$code" -eq 75 ]; then
        code=4
        if [ -e "$out/STOP" ]; then
            report "not requeued, since $out/STOP exists"
        elif [ -e "$start-before" ] && ! has_progressed "$start-before"; then
            report "not requeued: the last two starts completed no case and saved no checkpoint; increase the time limit or the number of ranks"
            code=3
        else
            requeue
        fi
    elif [ "$code" -gt 128 ]; then
        echo "exit code $code" >>"$killed"
        if [ "$(wc -l <"$killed")" -le "$retries" ]; then
            report "a rank was killed, perhaps because it exceeded the memory: retry $(wc -l <"$killed") of $retries"
            requeue
        fi
    fi
    return "$code"
}
