# What the scripts share; sourced by them, never run.
# shellcheck shell=sh

# The first Python that has numpy and h5py: the chosen one, that of the PATH, that of the system.
find_python() {
    for python in "${SHEARWAKE_PYTHON:-}" python3 /usr/bin/python3; do
        if [ -n "$python" ] && "$python" -c 'import numpy, h5py' >/dev/null 2>&1; then
            command -v "$python"
            return 0
        fi
    done
    echo "no Python with numpy and h5py; SHEARWAKE_PYTHON may name one" >&2
    return 6
}

# Cores as mpirun counts them: hardware threads of one core are one, and only ours count.
count_cores() {
    cores=$(lscpu -p=CORE,SOCKET 2>/dev/null | grep -v '^#' | sort -u | wc -l)
    mine=$(nproc 2>/dev/null || echo 1)
    if [ "$cores" -gt 0 ] && [ "$cores" -lt "$mine" ]; then
        echo "$cores"
    else
        echo "$mine"
    fi
}

# on_ranks N COMMAND...: mpirun as root (a container) and with fewer cores than ranks too.
on_ranks() {
    ranks=$1
    shift
    if [ "$(id -u)" -eq 0 ]; then
        export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
    fi
    if [ "$(count_cores)" -lt "$ranks" ]; then
        mpirun --oversubscribe -n "$ranks" "$@"
    else
        mpirun -n "$ranks" "$@"
    fi
}

# build PRESET FOLDER [TARGET]: configures and builds without a word; says what is wrong when it
# fails.
build() {
    mkdir -p "$2"
    if { cmake --preset "$1" && cmake --build --preset "$1" --target "${3:-all}"; } \
        >"$2/build.log" 2>&1; then
        return 0
    fi
    grep -m 20 -A 5 -E 'error|FAILED' "$2/build.log" >&2 || tail -n 40 "$2/build.log" >&2
    echo "the build failed; its log: $PWD/$2/build.log" >&2
    return 1
}
