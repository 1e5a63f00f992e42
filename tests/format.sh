#!/bin/sh
# Every file of C and C++ is as clang-format writes it, and no line of ours is longer than its limit; but the shipped
# headers, which the test `rooms` compares with the rooms that they are made of, and built models, which the test `tables are up
# to date` compares with what rbd-model writes: their tables take a tenth of the time.
# usage: format.sh DIRECTORY_OF_RBD_H   skipped (77) without the version that .clang-format is for
set -u

cd "${1:?usage: format.sh DIRECTORY_OF_RBD_H}" || exit 1
formatter=clang-format-19
command -v "$formatter" >/dev/null || { echo "$formatter is not installed"; exit 77; }

# The files, but those of build folders and the shipped headers.
sources() {
    find . -path './build*' -prune -o -path './.git' -prune -o -name node_modules -prune -o -path './rbd.h' -prune -o \
        -path './rbd_[!u]*.h' -prune -o -path './models/*_model.h' -prune -o -type f \
        \( -name '*.c' -o -name '*.h' -o -name '*.cpp' -o -name '*.hpp' -o -name '*.cu' -o -name '*.ino' \) -print
}

# shellcheck disable=SC2046 # no name of ours has a blank
set -- $(sources)
[ $# -ge 100 ] || { echo "only $# files found"; exit 1; }
status=0
"$formatter" --dry-run -Werror --ferror-limit=1 "$@" || {
    echo "write them anew: $formatter -i FILE"
    status=1
}
awk 'FILENAME !~ /^.\/models\/|_model.h$/ && length > 110 { print FILENAME ":" FNR ": more than 110 columns"; bad = 1 }
     END { exit bad }' "$@" || status=1
exit $status
