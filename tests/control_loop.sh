#!/bin/sh
# docs/control_loop.md: its program compiles, gives torques and refuses NaN; its table is what the calls do
# (control_loop.c); it names every status that a loop can meet, and no call that is not there.
# usage: control_loop.sh DIRECTORY_OF_RBD_H PROGRAM_OF_control_loop.c   with RBD_ALL_TESTS=yes the instructions near a singular
#     state of a second robot too
set -eu

root=$(realpath "${1:?usage: control_loop.sh DIRECTORY_OF_RBD_H PROGRAM}") program=$(realpath "$2")
page=$root/docs/control_loop.md
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"
failures=0
fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

awk '$0 == "```c" { inside = 1; next } inside && /^```/ { exit } inside' "$page" >loop.c
cat >main.c <<'END'
#include <math.h>
int control_start(void);
int control_step(const double encoder[7], const double speed[7], const double wanted[7], double motor[7]);
int main(void) {
    double q[7] = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7}, v[7] = {0}, motor[7] = {0};
    if (!control_start() || !control_step(q, v, q, motor) || !(motor[1] < -1 || motor[1] > 1)) return 1;
    q[3] = (double)NAN;
    return control_step(q, v, v, motor) ? 2 : 0;
}
END
printf '#define RBD_IMPLEMENTATION\n#include "rbd.h"\n#include "models/iiwa_model.h"\n' >library.c
for scalar in double float; do
    # shellcheck disable=SC2086 # CC may be "ccache cc"
    ${CC:-cc} -std=c99 -Wall -Wextra -pedantic -Wconversion -Werror -Dalways_inline=unused -DRBD_REAL=$scalar -I"$root" loop.c main.c \
        library.c -o loop -lm || fail "the program of the page does not compile, $scalar"
    ./loop || fail "the program of the page, $scalar: $?"
done

# The table, a line for each call.
awk -F'|' '/^\| call \|/ { inside = 1; next } inside && !/^\|/ { exit }
     inside && !/---/ { gsub(/[`, ]+/, " ", $2); gsub(/ /, "", $3); gsub(/ /, "", $4); n = split($2, name, " ")
                        for (i = 1; i <= n; i++) if (name[i] != "") print name[i], $3, $4 }' "$page" | sort >said
"$program" | sort >found
[ "$(wc -l <found)" -ge 35 ] || fail "the program printed $(wc -l <found) lines"
diff said found || fail "the page's table (<) is not what the calls do (>)"

# Statuses: those of rbd_model_build are none of a loop's.
grep -o 'RBD_ERR_[A-Z_]* = -[0-9]*' "$root/rbd.h" | awk '{ print $1 }' >all
for status in $(cat all); do
    case $status in
    *_COUNT | *_NAME | *_PARENT | *_TYPE | *_AXIS | *_PITCH | *_POSITION | *_ROTATION | *_MASS | *_COM | *_INERTIA | *_LEAF) ;;
    *_ARMATURE | *_DAMPING | *_FRICTION | *_LIMITS | *_MIMIC) ;;
    *) grep -q "\`$status\`" "$page" || fail "$status is not on the page" ;;
    esac
done
for word in $(grep -o 'RBD_ERR_[A-Z_]*' "$page" | sort -u); do grep -qx "$word" all || fail "there is no $word"; done
for call in $(grep -o '`rbd_[a-z_]*`' "$page" | tr -d '`' | sort -u); do
    grep -q "[ *]$call(" "$root/rbd.h" "$root/rbd_derivatives.h" "$root/rbd_constraints.h" "$root/rbd_contact.h" \
        "$root/rbd_ik.h" "$root/rbd_tasks.h" ||
        grep -q "} $call;\|struct $call " "$root/rbd.h" || fail "there is no $call"
done

# Near a singular state rbd_aba takes up to six times the instructions: the last link's mass put
# on its axis.
cat >near.c <<'END'
#define RBD_IMPLEMENTATION
#include "rbd.h"
#include "models/atlas.h"
#include "models/iiwa.h"
#include <string.h>
static rbd_body bodies[ATLAS_NB];
static unsigned char model_memory[RBD_MODEL_SIZE(ATLAS_NB)], work_memory[RBD_WORK_SIZE(ATLAS_NB, ATLAS_NV)];
int main(int argc, char **argv) {
    const int small = argv[1][0] == 'i', nb = small ? IIWA_NB : ATLAS_NB;
    rbd_body *last = &bodies[nb - 1];
    double q[ATLAS_NQ], v[ATLAS_NV], a[ATLAS_NV];
    const rbd_model *m;
    rbd_work *w;
    uint64_t seed = 1;
    memcpy(bodies, small ? iiwa_bodies : atlas_bodies, (size_t)nb * sizeof *bodies);
    memset(last->inertia, 0, argc > 2 ? sizeof last->inertia : 0);
    for (int i = 0; i < 3 && argc > 2; i++) last->com[i] = 0.1 * last->axis[i];
    if (rbd_model_build(bodies, nb, model_memory, sizeof model_memory, &m, NULL) ||
        rbd_work_init(m, work_memory, sizeof work_memory, &w) || rbd_random(m, &seed, q))
        return 9;
    for (int i = 0; i < rbd_nv(m); i++) v[i] = 0.1 * i;
    return -(int)rbd_aba(m, w, q, v, v, NULL, a);
}
END
# counted STATUS ARGUMENT...: instructions of the call
counted() {
    expected=$1 status=0
    shift
    valgrind --tool=callgrind --callgrind-out-file=/dev/null --toggle-collect=rbd_aba_double ./near "$@" >counts 2>&1 || status=$?
    [ "$status" -eq "$expected" ] || fail "near a singular state, $*: status -$status"
    sed -n 's/.*Collected : //p' counts
}
if command -v valgrind >/dev/null; then
    # shellcheck disable=SC2086
    ${CC:-cc} -std=c99 -O1 -Dalways_inline=unused -I"$root" near.c -o near -lm
    robots=iiwa:6
    if [ -n "${RBD_ALL_TESTS-}" ]; then robots="iiwa:6 atlas:6"; else echo "SKIPPED but by ./run test --all: the second robot"; fi
    for robot in $robots; do
        far=$(counted 0 "${robot%:*}") near=$(counted 6 "${robot%:*}" near)
        echo "${robot%:*}: $far instructions, near a singular state $near"
        [ "$far" -gt 1000 ] && [ "$near" -gt "$far" ] && [ "$near" -le $((far * ${robot#*:})) ] || fail "${robot%:*}: more than ${robot#*:} times"
    done
else
    echo "left out: near a singular state, for want of valgrind"
fi
[ "$failures" -eq 0 ]
