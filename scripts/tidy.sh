#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Runs clang-tidy on sources of the program with the compile commands of a clang build. Files that this build
# compiles in groups are checked in the same groups.
# Usage: scripts/tidy.sh BUILD [COMMIT]
#   BUILD:  build folder of the preset clang
#   COMMIT: check only files that differ from this commit; the complete tree takes tens of minutes
set -u
cd "$(dirname "$0")/.." || exit 6
build=$1
units=/src/
if [ $# -gt 1 ]; then
    units=""
    files=$(git -c safe.directory="$PWD" diff --name-only "$2" -- 'src/*.cpp') || exit 6
    for file in $files; do
        [ -f "$file" ] || continue
        united=$(grep -rlF "/$file\"" "$build/src" --include='unity_*.cxx')
        units="$units${units:+|}${united:-$file}\$"
    done
    if [ -z "$units" ]; then
        echo "no source file has changed since $2"
        exit 0
    fi
fi
log=$build/clang-tidy.log
if run-clang-tidy -quiet -p "$build" -j "$(nproc)" "$units" >"$log" 2>/dev/null; then
    exit 0
fi
grep -E -A 4 '(warning|error):' "$log" | head -n 200 >&2
echo "clang-tidy failed; output: $PWD/$log" >&2
exit 1
