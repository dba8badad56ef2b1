#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Formats every C++ file in place; with --check only lists the files that would change (exit 1). Other versions of
# clang-format than 14 format some lines differently; the environment variable CLANG_FORMAT selects one nevertheless.
set -eu
cd "$(dirname "$0")/.."
clang_format=$(command -v "${CLANG_FORMAT:-clang-format-14}") || {
    echo "clang-format-14 is missing" >&2
    exit 6
}
# safe.directory lets root work in a clone that belongs to another user.
files=$(git -c safe.directory="$PWD" ls-files --cached --others --exclude-standard '*.cpp' '*.hpp')
# shellcheck disable=SC2086 # a list of names without blanks
if [ "${1:-}" = "--check" ]; then
    exec "$clang_format" --dry-run --Werror $files
fi
# shellcheck disable=SC2086
exec "$clang_format" -i $files
