# SPDX-License-Identifier: BSD-3-Clause
# Functions of several scripts, which source this file.
# shellcheck shell=sh

# Prints the path of the first Python that has numpy, h5py and xxhash. Tries SHEARWAKE_PYTHON, then the PATH, then
# the system's Python.
find_python() {
    for python in "${SHEARWAKE_PYTHON:-}" python3 /usr/bin/python3; do
        if [ -n "$python" ] && "$python" -c 'import numpy, h5py, xxhash' >/dev/null 2>&1; then
            command -v "$python"
            return 0
        fi
    done
    echo "no Python with numpy, h5py and xxhash found; set SHEARWAKE_PYTHON to choose one" >&2
    return 6
}

# root: makes the modules of root/analysis importable, as in `python3 -m shearwake.nightly`
use_package() {
    export PYTHONPATH="$1/analysis${PYTHONPATH:+:$PYTHONPATH}" PYTHONSAFEPATH=1
}

# The number of cores that mpirun counts: physical cores that this process may use.
count_cores() {
    cores=$(lscpu -p=CORE,SOCKET 2>/dev/null | grep -v '^#' | sort -u | wc -l)
    mine=$(nproc 2>/dev/null || echo 1)
    if [ "$cores" -gt 0 ] && [ "$cores" -lt "$mine" ]; then
        echo "$cores"
    else
        echo "$mine"
    fi
}

# on_ranks N COMMAND...: runs mpirun, also as root (in a container) and with fewer cores than ranks, which Open MPI 4
# (OMPI) and 5 (PRTE) refuse otherwise. Without hwloc's OpenCL component, mpirun forwards SIGUSR1 (docs/how-to/cluster.md).
on_ranks() {
    ranks=$1
    shift
    if [ "$(id -u)" -eq 0 ]; then
        export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
    fi
    if [ "$(count_cores)" -lt "$ranks" ]; then
        export OMPI_MCA_rmaps_base_oversubscribe=1 PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe
    fi
    # All ranks are on this machine. Open MPI 5 would warn if the network does not lead back to it.
    export OMPI_MCA_btl="${OMPI_MCA_btl:-^tcp}"
    export HWLOC_COMPONENTS="${HWLOC_COMPONENTS--opencl}"
    mpirun -n "$ranks" "$@"
}

# show_steps LOG: copies the output of a build to LOG and shows its progress with the time that remains: on a terminal a
# line that is redrawn, elsewhere a line every 15 seconds.
show_steps() {
    began=$(date +%s)
    shown=$began
    while IFS= read -r line; do
        printf '%s\n' "$line" >>"$1"
        case $line in
        \[[0-9]*/[0-9]*\]*) steps=${line%%]*} ;;
        *) continue ;;
        esac
        steps=${steps#?} now=$(date +%s) left=""
        # As if the remaining steps took as long as those before.
        if [ $((now - began)) -ge 10 ] && [ "${steps%/*}" -gt 0 ]; then
            seconds=$(((now - began) * (${steps#*/} - ${steps%/*}) / ${steps%/*}))
            left=", about $((seconds / 60 + 1)) min left"
        fi
        if [ -t 1 ]; then
            printf '\r\033[Kbuilding [%s]%s' "$steps" "$left"
        elif [ $((now - shown)) -ge 15 ]; then
            echo "building [$steps]$left"
            shown=$now
        fi
    done
    if [ -t 1 ]; then printf '\r\033[K'; fi
}

# build PRESET FOLDER TARGET...: configures and builds, shows the progress, and prints the errors if the build
# fails. SHEARWAKE_WERROR=ON in the environment turns warnings into errors; a folder that was built without
# it is recompiled completely.
build() {
    preset=$1
    folder=$2
    shift 2
    for tool in cmake ninja; do
        if ! command -v "$tool" >/dev/null 2>&1; then
            echo "building needs $tool, which is not on the PATH: install it, load its module, or add its folder to PATH" >&2
            return 6
        fi
    done
    mkdir -p "$folder"
    : >"$folder/build.log"
    {
        if cmake --preset "$preset" ${SHEARWAKE_WERROR:+"-DSHEARWAKE_WERROR=$SHEARWAKE_WERROR"} &&
            cmake --build --preset "$preset" --target "$@"; then
            echo "the build is complete"
        fi
    } 2>&1 | show_steps "$folder/build.log"
    if [ "$(tail -n 1 "$folder/build.log")" = "the build is complete" ]; then
        return 0
    fi
    grep -m 1 -A 30 'CMake Error' "$folder/build.log" >&2 || # lists all missing libraries
        grep -m 20 -A 5 -E 'error|FAILED' "$folder/build.log" >&2 || tail -n 40 "$folder/build.log" >&2
    echo "the build failed; log: $PWD/$folder/build.log" >&2
    return 1
}

# run_tests FOLDER [ARGUMENTS OF CTEST ...]: runs tests of a build folder; the last line is `N passed, N failed`.
run_tests() {
    folder=$1
    shift
    rm -rf "$folder/test-results"
    mkdir "$folder/test-results"
    # Groups wait for files, time limits and browsers: with as many groups as cores a fifth of the cores rests.
    ctest --test-dir "$folder" --parallel $(($(nproc) + 2)) --output-junit test-results/ctest.xml "$@"
    "$python" scripts/count_tests.py "$folder"
}
