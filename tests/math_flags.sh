#!/bin/sh
# Flags that reassociate sums ruin the sine's argument reduction: the implementation refuses them where the
# compiler tells of them; where it does not (clang's -funsafe-math-optimizations), the sine stays right.
# usage: math_flags.sh DIRECTORY_OF_RBD_H [COMPILER...]
set -u

root=${1:?usage: math_flags.sh DIRECTORY_OF_RBD_H [COMPILER...]}
shift
[ $# -gt 0 ] || set -- gcc clang clang-16 clang-19
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
failures=0
checks=0

# The gravity torque of a pendulum, 1 kg at 1 m, is g sin(q), to about a hundred rounding units.
cat >"$scratch/program.c" <<'END'
#define RBD_STATIC
#define RBD_IMPLEMENTATION
#include "rbd.h"
#include <stdio.h>

int main(void) {
    static const rbd_body rod[1] = {
        {.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 1, 0}, .mass = 1, .com = {0, 0, -1}}};
    static unsigned char model_memory[RBD_MODEL_SIZE(1)], work_memory[RBD_WORK_SIZE(1, 1)];
    const double bound = sizeof(rbd_real) == sizeof(float) ? 1e-5 : 1e-14;
    const rbd_model *m;
    rbd_work *w;
    rbd_model_build(rod, 1, model_memory, sizeof model_memory, &m, NULL);
    rbd_work_init(m, work_memory, sizeof work_memory, &w);
    for (int i = -3000; i <= 3000; i++) {
        rbd_real q = (rbd_real)i * (rbd_real)0.0371, tau;
        rbd_gravity_torque(m, w, &q, &tau);
        const double error = (double)tau / 9.81 - sin((double)q);
        if (!(error < bound && error > -bound))
            return printf("sin(%g) is wrong by %g\n", (double)q, error);
    }
    return 0;
}
END
printf '#include "rbd.h"\n' >"$scratch/declarations.c"

# build FILE OUTPUT COMPILER FLAG...: OUTPUT is -c or -lm. A warning is an error, so that no flag is ignored
# in silence; that clang would rather not have -Ofast is none.
build() {
    file=$1 output=$2 compiler=$3
    shift 3
    "$compiler" -std=c99 -O2 -Dalways_inline=unused -Werror -Wno-deprecated -I"$root" "$@" "$scratch/$file.c" "$output" \
        -o "$scratch/out" >"$scratch/messages" 2>&1
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

# refused COMPILER FLAG...: the implementation is, by our own #error; declarations alone may pass
refused() {
    if build program -c "$@" || ! grep -q 'rbd: -ffast-math' "$scratch/messages"; then
        say "FAILED, not refused" "$@"
    elif ! build declarations -c "$@"; then
        say "FAILED, declarations refused too" "$@"
    else
        say "refused" "$@"
    fi
}

# right COMPILER FLAG...: the sine is
right() {
    if build program -lm "$@" && "$scratch/out" >"$scratch/messages" 2>&1; then
        say "sine right" "$@"
    else
        say "FAILED" "$@"
    fi
}

for compiler; do
    command -v "$compiler" >/dev/null 2>&1 || continue
    refused "$compiler" -ffast-math
    refused "$compiler" -Ofast
    case $("$compiler" --version) in
    *clang*) unsafe=right ;;
    *) unsafe=refused ;;
    esac
    for scalar in double float; do
        $unsafe "$compiler" -DRBD_REAL=$scalar -funsafe-math-optimizations
        $unsafe "$compiler" -DRBD_REAL=$scalar -fassociative-math -fno-signed-zeros -fno-trapping-math
        right "$compiler" -DRBD_REAL=$scalar -O3 -ffp-contract=fast
        right "$compiler" -DRBD_REAL=$scalar -ffinite-math-only
    done
done

echo "$checks checks, $failures failed"
[ "$checks" -gt 0 ] && [ "$failures" -eq 0 ]
