#!/bin/sh
# Files of one program that differ in their scalar (RBD_REAL, RBD_LANES) must not link: they would read
# each other's arrays wrongly. Files that agree must.
# usage: scalar_link.sh DIRECTORY_OF_RBD_H [COMPILER]
set -eu

root=${1:?usage: scalar_link.sh DIRECTORY_OF_RBD_H [COMPILER]}
compiler=${2-${CC:-cc}}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
failures=0

printf '#define RBD_IMPLEMENTATION\n#include "rbd.h"\n' >"$scratch/library.c"
cat >"$scratch/user.c" <<'END'
#include "rbd.h"

static rbd_real q[1], tau[1];

int main(void) {
    static const rbd_body rod[1] = {
        {.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 1, 0}, .mass = 1, .com = {0, 0, 1}}};
    static unsigned char model_memory[RBD_MODEL_SIZE(1)], work_memory[RBD_WORK_SIZE(1, 1)];
    const rbd_model *m;
    rbd_work *w;
    return rbd_model_build(rod, 1, model_memory, sizeof model_memory, &m, NULL) ||
           rbd_work_init(m, work_memory, sizeof work_memory, &w) || rbd_gravity(m, w, q, tau);
}
END

# object FILE SCALAR: compiles a file with this scalar, e.g. float or double:4 for four lanes; without
# warnings, as compilers have much to say of vectors that are passed in memory
object() {
    lanes=
    case $2 in *:*) lanes=-DRBD_LANES=${2#*:} ;; esac
    # shellcheck disable=SC2086 # words wanted
    $compiler -std=c99 -w -Wno-psabi -I"$root" -DRBD_REAL="${2%:*}" $lanes \
        -c "$scratch/$1.c" -o "$scratch/$1-$2.o"
}

# expect RESULT USER LIBRARY: links a user's file of one scalar with the library of another
expect() {
    # shellcheck disable=SC2086 # words wanted
    if $compiler "$scratch/user-$2.o" "$scratch/library-$3.o" -o "$scratch/program" -lm \
        >"$scratch/messages" 2>&1; then
        result=links
    elif grep -q rbd_work_init "$scratch/messages"; then # and for no other reason
        result=refused
    else
        result=error
        cat "$scratch/messages"
    fi
    verdict=ok
    [ "$result" = "$1" ] || verdict=FAILED failures=$((failures + 1))
    [ "$result" != links ] || "$scratch/program" || verdict=FAILED failures=$((failures + 1))
    printf '%-9s user, %-9s library: %-8s %s\n' "$2" "$3" "$result" "$verdict"
}

scalars="double float double:4 double:8 float:4"
for scalar in $scalars; do
    object user "$scalar"
    object library "$scalar"
done
for user in $scalars; do
    for library in $scalars; do
        if [ "$user" = "$library" ]; then
            expect links "$user" "$library"
        else
            expect refused "$user" "$library"
        fi
    done
done
[ "$failures" -eq 0 ]
