#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Fuzzes the reader of jobs with libFuzzer and the sanitizers of clang, for ten minutes or the given number of seconds. An
# input may take 500 MB, including the sanitizers; libFuzzer ends one that hangs, and the time of the slowest one is printed.
# New inputs are added to the corpus folder in build-fuzz/. An input that breaks the reader is stored in a file, and the
# script ends with an exit code.
# Usage: tests/fuzz/long_form.sh [SECONDS]        Needs clang (apt-get install clang)
set -eu
cd "$(dirname "$0")/../.."
seconds=${1:-600}
. scripts/common.sh
build fuzz build-fuzz fuzz_job
cd build-fuzz
# Leaks of MPI are ignored.
export ASAN_OPTIONS=detect_leaks=0:quarantine_size_mb=16
mkdir -p corpus/job artifacts
./fuzz_job -max_total_time="$seconds" -rss_limit_mb=500 -max_len=70000 -print_final_stats=1 \
    -artifact_prefix=artifacts/job- corpus/job ../tests/fuzz/corpus/job >job.log 2>&1 ||
    { tail -n 40 job.log; exit 1; }
grep -E "stat::number_of_executed_units|stat::new_units_added|stat::slowest_unit_time_sec" job.log
echo "no crash in $seconds s"
