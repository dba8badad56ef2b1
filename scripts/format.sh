#!/bin/sh
# Formats every C++ file in place; with --check only says which ones would change (exit 1).
set -eu
cd "$(dirname "$0")/.."
clang_format=$(command -v clang-format-14 || command -v clang-format)
# Also where root works in somebody else's clone.
files=$(git -c safe.directory="$PWD" ls-files --cached --others --exclude-standard '*.cpp' '*.hpp')
# shellcheck disable=SC2086 # a list of names without blanks
if [ "${1:-}" = "--check" ]; then
    exec "$clang_format" --dry-run --Werror $files
fi
# shellcheck disable=SC2086
exec "$clang_format" -i $files
