#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Runs the checks that need no build: licence lines, wording, and pyflakes for Python. Exit 1 if a check fails.
set -u
cd "$(dirname "$0")/.." || exit 6
code=0

# safe.directory lets root work in a clone that belongs to another user.
files=$(git -c safe.directory="$PWD" ls-files --cached --others --exclude-standard)
python=""
for file in $files; do
    [ -f "$file" ] || continue
    case $file in
    *.py) python="$python $file" ;;
    *.cpp | *.hpp | *.sh | *.cmake | */CMakeLists.txt | CMakeLists.txt) ;;
    *.*) continue ;;
    *)
        case $(head -c 64 "$file" | tr -d '\0' | head -n 1) in
        '#!'*python*) python="$python $file" ;;
        '#!'*) ;;
        *) continue ;;
        esac
        ;;
    esac
    if ! head -n 3 "$file" | grep -q 'SPDX-License-Identifier: BSD-3-Clause$'; then
        echo "$file: the line SPDX-License-Identifier: BSD-3-Clause is missing"
        code=1
    fi
done

scripts/check_wording.py || code=1

# The package python3-pyflakes installs pyflakes for the system's Python only.
for interpreter in /usr/bin/python3 python3; do
    if "$interpreter" -c 'import pyflakes' >/dev/null 2>&1; then
        # shellcheck disable=SC2086 # a list of names without blanks
        "$interpreter" -m pyflakes $python || code=1
        exit "$code"
    fi
done
echo "pyflakes is missing; scripts/setup --tests installs it" >&2
exit 6
