#!/bin/sh
# Formats every C++ file in place; with --check only says which ones would change (exit 1).
set -eu
cd "$(dirname "$0")/.."
clang_format=$(command -v clang-format-14 || command -v clang-format)
files=$(git ls-files --cached --others --exclude-standard '*.cpp' '*.hpp')
if [ "${1:-}" = "--check" ]; then
    exec "$clang_format" --dry-run --Werror $files
fi
exec "$clang_format" -i $files
