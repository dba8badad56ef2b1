#!/bin/sh
# The readers of job files and of case files through libFuzzer, with the sanitizers of clang: ten
# minutes each, or as many seconds as are given. What it finds new is added to the corpus folder
# that is kept in build-fuzz/; what breaks a reader ends it with an exit code and a file to look at.
# Usage: tests/fuzz/long_form.sh [SECONDS]        Needs clang (apt-get install clang)
set -eu
cd "$(dirname "$0")/../.."
seconds=${1:-600}
. scripts/common.sh
build fuzz build-fuzz fuzz_job
build fuzz build-fuzz fuzz_case
cd build-fuzz
# Leaks are MPI's own. What HDF5 breaks down on in the copy of the process is meant to.
export ASAN_OPTIONS=detect_leaks=0
for reader in job case; do
    mkdir -p "corpus/$reader" artifacts
    "./fuzz_$reader" -max_total_time="$seconds" -timeout=120 -rss_limit_mb=4096 -max_len=70000 \
        -print_final_stats=1 -artifact_prefix="artifacts/$reader-" \
        "corpus/$reader" "../tests/fuzz/corpus/$reader" >"$reader.log" 2>&1 ||
        { tail -n 40 "$reader.log"; exit 1; }
    grep -E "stat::number_of_executed_units|stat::new_units_added" "$reader.log"
done
echo "no crash in $seconds s each"
