#!/bin/sh
# RBD_NO_...: with each part left out alone, with each pair of those that depend on each other, with all but one,
# and with all, the header compiles without a warning, and what it declares is what it defines. What a part holds is
# checked part by part; models with mimic joints are refused where nothing is left to solve them; batches without
# their calls are an error.
# usage: parts.sh DIRECTORY_OF_RBD_H
set -u

root=${1:?usage: parts.sh DIRECTORY_OF_RBD_H}
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
warnings="-pedantic -Wall -Wextra -Wconversion -Wdouble-promotion -Wshadow -Wvla -Wundef -Werror"
parts="BUILD PAYLOAD RNEA CRBA ABA HYBRID OBSERVER CHOLESKY MINVERSE KINEMATICS WRENCH POINTS MANIFOLD LOOKUP TEXT"
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

# A part alone is left out by the compiler of the build. Of the many combinations clang tells the same, what is unused or
# missing, in a third of the time.
compiler=${CC:-cc}
by_clang() { ! command -v clang-19 >/dev/null || compiler=clang-19; }

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
        grep -o 'extern [^;(]* \**rbd_[a-z_]* *(' | sed 's/.*rbd_/rbd_/; s/ *($//; s/_double$//' | grep -v '^rbd_batch' |
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

leave_out
cp "$scratch/defined" "$scratch/all"
holds BUILD rbd_model_build rbd_model_size rbd_add_payload rbd_describe
holds PAYLOAD rbd_add_payload
holds RNEA rbd_rnea rbd_bias rbd_gravity rbd_fd_cholesky rbd_hybrid
holds CRBA rbd_crba rbd_crba_packed rbd_fd_cholesky rbd_hybrid rbd_minverse
holds ABA rbd_aba
holds HYBRID rbd_hybrid
holds OBSERVER rbd_generalized_momentum
holds WRENCH rbd_joint_wrench
holds CHOLESKY rbd_cholesky_factor rbd_cholesky_factor_packed rbd_cholesky_solve rbd_cholesky_solve_many \
    rbd_fd_cholesky rbd_hybrid rbd_minverse
holds MINVERSE rbd_minverse
points="rbd_jacobian rbd_relative_jacobian rbd_jacobian_transpose rbd_point_position rbd_point_velocity rbd_point_acceleration
    rbd_point_wrench rbd_momentum"
# shellcheck disable=SC2086 # words wanted
holds KINEMATICS rbd_kinematics rbd_body_pose rbd_body_velocity rbd_body_acceleration \
    rbd_body_acceleration_classical rbd_com rbd_energy rbd_mass rbd_joint_wrench $points
# shellcheck disable=SC2086 # words wanted
holds POINTS $points
holds MANIFOLD rbd_neutral rbd_integrate rbd_difference rbd_random rbd_rates_from_velocity \
    rbd_velocity_from_rates
holds LOOKUP rbd_body_index rbd_joint_index rbd_body_name rbd_joint_name rbd_joint rbd_dof_body \
    rbd_describe
holds TEXT rbd_status_string rbd_finding_text

by_clang
for one in $parts; do
    rest=
    for other in $parts; do
        [ "$other" = "$one" ] || rest="$rest $other"
    done
    # shellcheck disable=SC2086 # words wanted
    leave_out $rest
done
# shellcheck disable=SC2086 # words wanted
leave_out $parts
later="BUILD RNEA CRBA ABA CHOLESKY MINVERSE" # those that depend on each other
for one in $later; do
    later=${later#"$one"}
    later=${later# }
    for other in $later; do
        leave_out "$one" "$other"
    done
done

# The header on the common frame.
compiler=${CC:-cc}
echo '#include "rbd_derivatives.h"' >"$scratch/declarations.c"
printf '#define RBD_IMPLEMENTATION\n#include "rbd_derivatives.h"\n' >"$scratch/rbd.c"
leave_out
cp "$scratch/defined" "$scratch/all"
steps="rbd_integrate_derivatives rbd_difference_derivatives"
holds MOMENTUM rbd_momentum_matrix rbd_com_jacobian
holds CORIOLIS rbd_coriolis
holds HYBRID rbd_hybrid rbd_rnea_free_base
holds REGRESSOR rbd_regressor rbd_energy_regressors rbd_body_parameters rbd_set_parameters rbd_check_parameters
# shellcheck disable=SC2086 # words wanted
holds DERIVATIVES rbd_rnea_derivatives rbd_gravity_derivatives rbd_keep_zeros rbd_fd_derivatives $steps
leave_out MANIFOLD
[ "$(comm -23 "$scratch/all" "$scratch/defined" | grep -c derivatives)" -eq 2 ] || fail "MANIFOLD: $steps"
by_clang
leave_out MINVERSE
# shellcheck disable=SC2086 # words wanted
leave_out $parts MOMENTUM CORIOLIS REGRESSOR DERIVATIVES
echo '#include "rbd.h"' >"$scratch/declarations.c"
printf '#define RBD_IMPLEMENTATION\n#include "rbd.h"\n' >"$scratch/rbd.c"

for part in RNEA CRBA ABA CHOLESKY; do
    if compile -DRBD_BATCH_IMPLEMENTATION -DRBD_LANES=2 "-DRBD_NO_$part" ||
        ! grep -q 'rbd: the batch calls need' "$scratch/messages"; then
        fail "batches without $part are not refused"
    fi
done

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
mimic 28 -DRBD_NO_CRBA
mimic 0 -DRBD_NO_CRBA -DRBD_NO_ABA

# Where what judges is left out, a state in doubt is singular, and one that is not has its acceleration.
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
for flags in "" -DRBD_NO_CHOLESKY -DRBD_NO_CRBA "-DRBD_NO_CHOLESKY -DRBD_NO_CRBA"; do
    # shellcheck disable=SC2086 # words wanted
    if ! ${CC:-cc} -std=c99 -I"$root" $flags "$scratch/doubt.c" -o "$scratch/doubt" -lm || ! "$scratch/doubt"; then
        fail "states in doubt, $flags"
    fi
done

echo "$combinations combinations, $failures failed"
[ "$combinations" -ge 30 ] && [ "$failures" -eq 0 ]
