#!/bin/sh
# Flags that reassociate sums ruin the sine's argument reduction, and those that take NaN for impossible remove the checks
# for it: the implementation refuses them. With the other parts of -ffast-math the sine and the checks stay right.
# usage: math_flags.sh DIRECTORY_OF_RBD_H [COMPILER...]   with RBD_ALL_TESTS=yes sine and checks with each flag, scalar and
#     compiler at -O3 and -O2; else with each flag by gcc and clang-19 at -O1, where both compilers use what it allows, and of
#     the other compilers whether they refuse one flag
set -u

root=${1:?usage: math_flags.sh DIRECTORY_OF_RBD_H [COMPILER...]}
shift
[ $# -gt 0 ] || set -- gcc g++ clang clang-16 clang-19 clang++-19
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
failures=0
checks=0

# The gravity torque of a pendulum, 1 kg at 1 m, is g sin(q), to about a hundred rounding units. Two rods are dynamic, unless
# the angle of the second is not a number. Of two joints on one axis the first carries nothing: M is singular.
cat >"$scratch/program.c" <<'END'
#define RBD_STATIC
#define RBD_IMPLEMENTATION
#include "rbd.h"
#include <stdio.h>
#include <string.h>

#define TURNS .type = RBD_REVOLUTE, .axis = {0, 1, 0}
#define ROD .mass = 1, .com = {0, 0, -1}

static unsigned char model_memory[RBD_MODEL_SIZE(2)], work_memory[RBD_WORK_SIZE(2, 2)];
static const rbd_model *m;
static rbd_work *w;

static void make(const rbd_body *bodies, int n) {
    rbd_model_build(bodies, n, model_memory, sizeof model_memory, &m, NULL);
    rbd_work_init(m, work_memory, sizeof work_memory, &w);
}

static int right_sines(void) {
    const double bound = sizeof(rbd_real) == sizeof(float) ? 1e-5 : 1e-14;
    for (int i = -3000; i <= 3000; i++) {
        rbd_real q = (rbd_real)i * (rbd_real)0.0371, tau;
        rbd_gravity_torque(m, w, &q, &tau);
        const double error = (double)tau / 9.81 - sin((double)q);
        if (!(error < bound && error > -bound)) return printf("sin(%g) is wrong by %g\n", (double)q, error), 0;
    }
    return 1;
}

/* Both kinds of forward dynamics give this status. */
static int both_say(rbd_status expected, rbd_real q1) {
    const rbd_real q[2] = {(rbd_real)0.1, q1}, v[2] = {0, 0}, tau[2] = {0, 1};
    rbd_real a[2];
    const int aba = rbd_aba(m, w, q, v, tau, NULL, a), cholesky = rbd_fd_cholesky(m, w, q, v, tau, NULL, a);
    if (aba == expected && cholesky == expected) return 1;
    return printf("aba %d and fd_cholesky %d instead of %d\n", aba, cholesky, expected), 0;
}

int main(void) {
    const rbd_body rods[2] = {{.parent = -1, TURNS, ROD}, {.parent = 0, TURNS, .position = {0, 0, -1}, ROD}};
    const rbd_body one_axis[2] = {{.parent = -1, TURNS}, {.parent = 0, TURNS, ROD}};
    rbd_real nan;
    memset(&nan, -1, sizeof nan);
    make(rods, 1);
    if (!right_sines()) return 1;
    make(rods, 2);
    if (!both_say(RBD_OK, 1) || !both_say(RBD_ERR_NAN, nan)) return 1;
    make(one_axis, 2);
    return !both_say(RBD_ERR_SINGULAR, 1);
}
END
printf '#include "rbd.h"\n' >"$scratch/declarations.c"
# The implementation, of which clang compiles one call: it sees some options only then. Below the same options in the file.
cat >"$scratch/small.c" <<'END'
#define RBD_STATIC
#define RBD_IMPLEMENTATION
#include "rbd.h"
rbd_status call(const rbd_model *m, void *memory, size_t size, rbd_work **w);
rbd_status call(const rbd_model *m, void *memory, size_t size, rbd_work **w) { return rbd_work_init(m, memory, size, w); }
END
printf '#pragma GCC optimize("finite-math-only")\n#include "small.c"\n' >"$scratch/pragma_gcc.c"
printf '#pragma float_control(precise, off)\n#include "small.c"\n' >"$scratch/pragma_clang.c"

all=${RBD_ALL_TESTS-}
level=-O1
[ -z "$all" ] || level=-O2

# build FILE OUTPUT COMPILER FLAG...: OUTPUT is -c or -lm. A warning is an error,
# so that no flag is ignored in silence; that clang would rather not have -Ofast is none.
build() {
    file=$1 output=$2 compiler=$3
    shift 3
    case $compiler in *++*) language='c++ -std=c++20' ;; *) language='c -std=c99' ;; esac
    # shellcheck disable=SC2086 # words wanted
    "$compiler" -x $language $level -Dalways_inline=unused -Werror -Wno-deprecated -I"$root" "$@" \
        "$scratch/$file.c" "$output" -o "$scratch/out" >"$scratch/messages" 2>&1
}

# say VERDICT COMPILER FLAG...: prints and counts
say() {
    verdict=$1
    shift
    checks=$((checks + 1))
    printf '%s: %s\n' "$*" "$verdict"
    case $verdict in
    FAILED*) failures=$((failures + 1)) && sed -n '1,10p' "$scratch/messages" ;;
    esac
}

# refused FILE COMPILER FLAG...: the implementation in the file is, by our own error; declarations alone may pass
refused() {
    source=$1
    shift
    if build "$source" -c "$@" || ! grep -q 'rbd: -f\|rbd_needs_no_fsingle' "$scratch/messages"; then
        say "FAILED, $source not refused" "$@"
    elif ! build declarations -c "$@"; then
        say "FAILED, declarations refused too" "$@"
    else
        say "$source refused" "$@"
    fi
}

# right COMPILER FLAG...: sine and checks are. What optimises C++ is what optimises C.
right() {
    case $1 in *++*) return ;; esac
    if build program -lm "$@" && "$scratch/out" >"$scratch/messages" 2>&1; then
        say "right" "$@"
    else
        say "FAILED" "$@"
    fi
}

for compiler; do
    command -v "$compiler" >/dev/null 2>&1 || continue
    refused small "$compiler" -ffast-math
    case $all$compiler in gcc | clang-19 | yes*) ;; *) continue ;; esac
    refused small "$compiler" -Ofast
    refused small "$compiler" -ffinite-math-only
    case $("$compiler" --version) in
    *clang*)
        refused small "$compiler" -fno-honor-nans
        refused small "$compiler" -fno-honor-infinities
        refused pragma_clang "$compiler"
        right "$compiler" -O0 -fno-honor-nans -funsafe-math-optimizations
        ;;
    *)
        refused small "$compiler" -fsingle-precision-constant
        refused pragma_gcc "$compiler"
        right "$compiler" -DRBD_REAL=float -fsingle-precision-constant
        ;;
    esac
    others="-freciprocal-math -fno-signed-zeros -fno-trapping-math -fno-math-errno"
    for scalar in double float; do
        refused small "$compiler" -DRBD_REAL=$scalar -funsafe-math-optimizations
        refused small "$compiler" -DRBD_REAL=$scalar -fassociative-math -fno-signed-zeros -fno-trapping-math
        [ -n "$all" ] || continue
        right "$compiler" -DRBD_REAL=$scalar -O3 -ffp-contract=fast
        # shellcheck disable=SC2086 # words wanted
        right "$compiler" -DRBD_REAL=$scalar $others
    done
    # shellcheck disable=SC2086 # words wanted
    [ -n "$all" ] || right "$compiler" -DRBD_REAL=double $others
done
[ -n "$all" ] || echo "SKIPPED but by ./run test --all: -O2, -O3, and sine and checks with each scalar, each flag by other compilers"

echo "$checks checks, $failures failed"
[ "$checks" -gt 0 ] && [ "$failures" -eq 0 ]
