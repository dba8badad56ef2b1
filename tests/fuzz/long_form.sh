#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Fuzzes the readers of jobs, case files, maps, motions and studies with libFuzzer and the sanitizers of clang, and that of
# scans with changed files, for ten minutes each or the given number of seconds. An input may take 500 MB, including the
# sanitizers; libFuzzer ends one that hangs, and the time of the slowest one is printed. New inputs are added to the corpus
# folder in build-fuzz/. An input that breaks a reader is stored in a file, and the script ends with an exit code.
# Usage: tests/fuzz/long_form.sh [SECONDS]        Needs clang (apt-get install clang)
set -eu
cd "$(dirname "$0")/../.."
seconds=${1:-600}
. scripts/common.sh
build fuzz build-fuzz fuzz_job fuzz_case fuzz_map fuzz_motion fuzz_study
cd build-fuzz
# Leaks of MPI are ignored. Crashes of HDF5 in the forked child are expected.
export ASAN_OPTIONS=detect_leaks=0:quarantine_size_mb=16
for reader in job case map motion study; do
    mkdir -p "corpus/$reader" artifacts
    "./fuzz_$reader" -max_total_time="$seconds" -rss_limit_mb=500 -max_len=70000 \
        -print_final_stats=1 -artifact_prefix="artifacts/$reader-" \
        "corpus/$reader" "../tests/fuzz/corpus/$reader" >"$reader.log" 2>&1 ||
        { tail -n 40 "$reader.log"; exit 1; }
    grep -E "stat::number_of_executed_units|stat::new_units_added|stat::slowest_unit_time_sec" "$reader.log"
done
cd ..
PYTHONPATH=analysis /usr/bin/python3 tests/fuzz/fuzz_scan.py "$seconds"
echo "no crash in $seconds s each"
