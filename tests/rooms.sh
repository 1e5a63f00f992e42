#!/bin/sh
# The shipped headers are what src/ makes; includes and storeys are in order (tests/adequacy/rooms.py); each room
# compiles alone: by tcc, which takes a few milliseconds for each, and by CC those of batches, whose lanes tcc has not. With
# RBD_ALL_TESTS=yes, or without tcc, all by CC.
# usage: rooms.sh DIRECTORY_OF_RBD_H
set -u

root=${1:?usage: rooms.sh DIRECTORY_OF_RBD_H}
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
messages=$scratch/messages object=$scratch/room.o
status=0
python3 "$root/src/amalgamate.py" --check || status=1
python3 "$root/tests/adequacy/rooms.py" || status=1
cd "$root/src" || exit 1
quick="tcc -c -o $object"
if [ -n "${RBD_ALL_TESTS-}" ] || ! command -v tcc >/dev/null; then quick="${CC:-cc} -fsyntax-only"; fi
for room in */*.h; do
    head -n 1 "$room" | grep -q '^#ifndef RBDI_' || continue # text that rooms include
    compiler=$quick lanes=
    case $room in batch/*) compiler="${CC:-cc} -fsyntax-only" lanes=-DRBD_LANES=2 ;; esac
    # shellcheck disable=SC2086 # words wanted
    echo "#include \"$room\"" | $compiler -std=c99 -Wall -Wextra -Werror -Wno-unused-function $lanes -I. -x c - 2>"$messages" ||
        { echo "$room does not compile alone"; sed -n 1,4p "$messages"; status=1; }
done
exit $status
