#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Reports clang's warnings and runs clang-tidy on sources of the program. Those that the build compiles in groups are
# checked in the same groups. No code is generated, only precompiled headers.
# Usage: scripts/tidy.sh [COMMIT]
#   COMMIT: only files that differ from this commit; the complete tree takes tens of minutes
set -u
cd "$(dirname "$0")/.." || exit 6
build=build-clang
mkdir -p "$build"
log=$build/clang-tidy.log
if ! cmake --preset clang >"$log" 2>&1; then
    cat "$log" >&2
    exit 1
fi
units=/src/
if [ $# -gt 0 ]; then
    units=""
    files=$(git -c safe.directory="$PWD" diff --name-only "$1" -- 'src/*.cpp') || exit 6
    for file in $files; do
        [ -f "$file" ] || continue
        united=$(grep -rlF "/$file\"" "$build/src" --include='unity_*.cxx')
        units="$units${units:+|}${united:-$file}\$"
    done
    if [ -z "$units" ]; then
        echo "no source file has changed since $1"
        exit 0
    fi
fi
if ! cmake --build "$build" --target git_id shearwake_precompiled-O2 shearwake_precompiled-Og >"$log"; then
    cat "$log" >&2
    exit 1
fi
if run-clang-tidy -quiet -p "$build" -j "$(nproc)" "$units" >"$log" 2>/dev/null; then
    exit 0
fi
grep -E -A 4 '(warning|error):' "$log" | head -n 200 >&2
echo "clang-tidy failed; output: $PWD/$log" >&2
exit 1
