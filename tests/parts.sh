#!/bin/sh
# RBD_NO_BUILD and RBD_NO_CHOLESKY: with each and with both the headers compile without a warning, and what they declare
# is what they define. What a part holds is checked; models with mimic joints are refused where nothing is left to
# solve them; constraints without the factor are an error.
# usage: parts.sh DIRECTORY_OF_RBD_H   with RBD_ALL_TESTS=yes rbd.h alone too, else with rbd_derivatives.h
set -u

root=${1:?usage: parts.sh DIRECTORY_OF_RBD_H}
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
warnings="-pedantic -Wall -Wextra -Wconversion -Wdouble-promotion -Wshadow -Wvla -Wundef -Werror"
combinations=0
failures=0

echo '#include "rbd.h"' >"$scratch/declarations.c"
printf '#define RBD_IMPLEMENTATION\n#include "rbd.h"\n' >"$scratch/rbd.c"

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# flags PART...
flags() {
    for part; do printf -- '-DRBD_NO_%s ' "$part"; done
}

compiler=${CC:-cc}

# compile FLAG...: in a third of the time without forced inlining
compile() {
    # shellcheck disable=SC2086 # words wanted
    $compiler -std=c99 -O0 -Dalways_inline=unused $warnings -I"$root" "$@" -c "$scratch/rbd.c" -o "$scratch/rbd.o" 2>"$scratch/messages"
}

# leave_out PART...
leave_out() {
    combinations=$((combinations + 1))
    # shellcheck disable=SC2046 # words wanted
    if ! compile $(flags "$@"); then
        fail "without $*"
        sed -n '1,5p' "$scratch/messages"
        return
    fi
    # shellcheck disable=SC2046,SC2086 # words wanted
    ${CC:-cc} -std=c99 -E -P $(flags "$@") -I"$root" "$scratch/declarations.c" | tr '\n' ' ' |
        grep -o 'extern [^;(]* \**rbd_[a-z_]* *(' | sed 's/.*rbd_/rbd_/; s/ *($//; s/_double$//' |
        sort -u >"$scratch/declared"
    nm "$scratch/rbd.o" | awk '$2 == "T" { sub(/_double$/, "", $3); print $3 }' | sort -u >"$scratch/defined"
    [ -s "$scratch/declared" ] && diff "$scratch/declared" "$scratch/defined" ||
        fail "without $*: declared (<) is not what is defined (>)"
}

# holds PART FUNCTION...: leaving the part out leaves out just these
holds() {
    part=$1
    shift
    # shellcheck disable=SC2046 # words wanted
    leave_out "$part"
    comm -23 "$scratch/all" "$scratch/defined" >"$scratch/gone"
    printf '%s\n' "$@" | sort | diff - "$scratch/gone" || fail "$part: expected (<) is not what is gone (>)"
}

build="rbd_model_build rbd_model_build_kinematic rbd_model_size rbd_add_payload rbd_lock_joints rbd_describe"
factor="rbd_cholesky_factor rbd_cholesky_factor_packed rbd_cholesky_solve rbd_cholesky_solve_many rbd_fd_cholesky rbd_minverse
    rbd_hybrid rbd_free_step"
least_combinations=4
if [ -n "${RBD_ALL_TESTS-}" ]; then
    least_combinations=8
    leave_out
    cp "$scratch/defined" "$scratch/all"
    # shellcheck disable=SC2086 # words wanted
    holds BUILD $build
    # shellcheck disable=SC2086 # words wanted
    holds CHOLESKY $factor
    leave_out BUILD CHOLESKY
else
    echo "SKIPPED but by ./run test --all: rbd.h without rbd_derivatives.h"
fi

echo '#include "rbd_derivatives.h"' >"$scratch/declarations.c"
printf '#define RBD_IMPLEMENTATION\n#include "rbd_derivatives.h"\n' >"$scratch/rbd.c"
leave_out
cp "$scratch/defined" "$scratch/all"
# shellcheck disable=SC2086 # words wanted
holds BUILD $build rbd_set_parameters rbd_check_parameters
# shellcheck disable=SC2086 # words wanted
holds CHOLESKY $factor rbd_fd_derivatives rbd_id_free_base
leave_out BUILD CHOLESKY

printf '#define RBD_IMPLEMENTATION\n#include "rbd_constraints.h"\n' >"$scratch/rbd.c"
compile -DRBD_NO_CHOLESKY || grep -q 'rbd: rbd_constraints.h needs' "$scratch/messages" || fail "constraints without CHOLESKY"

cat >"$scratch/mimic.c" <<'END'
#define RBD_IMPLEMENTATION
#include "rbd.h"
int main(void) {
    static const rbd_body fingers[2] = {
        {.parent = -1, .joint = "a", .type = RBD_REVOLUTE, .axis = {0, 0, 1}, .mass = 1, .com = {1, 0, 0}},
        {.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, .mass = 1, .com = {1, 0, 0}, .mimic = "a",
         .mimic_ratio = 1}};
    static unsigned char model_memory[RBD_MODEL_SIZE(2)], work_memory[RBD_WORK_SIZE_MIMIC(2, 1)];
    const rbd_model *m;
    rbd_work *w;
    return rbd_model_build(fingers, 2, model_memory, sizeof model_memory, &m, NULL) != RBD_OK
               ? 100
               : -(int)rbd_work_init(m, work_memory, sizeof work_memory, &w);
}
END
# mimic STATUS FLAG...: rbd_work_init gives it
mimic() {
    status=$1
    shift
    ${CC:-cc} -std=c99 -Dalways_inline=unused -I"$root" "$@" "$scratch/mimic.c" -o "$scratch/mimic" -lm || fail "mimic joints, $*: compile"
    "$scratch/mimic"
    given=$?
    [ "$given" -eq "$status" ] || fail "mimic joints, $*: status -$given, not -$status"
}
mimic 0
mimic 28 -DRBD_NO_CHOLESKY # RBD_ERR_LEFT_OUT

# rbd_aba decides without the factor: a singular state is refused, and one that is not has its acceleration.
cat >"$scratch/doubt.c" <<'END'
#define RBD_IMPLEMENTATION
#include "rbd.h"
/* A point mass on its axis, at this distance from it. */
static int status(double distance, double a[1]) {
    const rbd_body bead[1] = {{.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, .mass = 1, .com = {distance, 0, 1}}};
    static unsigned char model_memory[RBD_MODEL_SIZE(1)], work_memory[RBD_WORK_SIZE(1, 1)];
    const double x[1] = {1};
    const rbd_model *m;
    rbd_work *w;
    if (rbd_model_build(bead, 1, model_memory, sizeof model_memory, &m, NULL) != RBD_OK ||
        rbd_work_init(m, work_memory, sizeof work_memory, &w) != RBD_OK)
        return 1;
    return rbd_aba(m, w, x, x, x, NULL, a);
}
int main(void) {
    double a[3];
    return status(0, a) != RBD_ERR_SINGULAR || a[0] < 0 || a[0] > 0 || status(1e-12, a + 1) != RBD_ERR_SINGULAR ||
           status(1e-3, a + 2) != RBD_OK || !(a[2] > 0.99e6 && a[2] < 1.01e6);
}
END
for flags in "" -DRBD_NO_CHOLESKY; do
    # shellcheck disable=SC2086 # words wanted
    if ! ${CC:-cc} -std=c99 -Dalways_inline=unused -I"$root" $flags "$scratch/doubt.c" -o "$scratch/doubt" -lm || ! "$scratch/doubt"; then
        fail "states in doubt, $flags"
    fi
done

echo "$combinations combinations, $failures failed"
[ "$combinations" -ge $least_combinations ] && [ "$failures" -eq 0 ]
