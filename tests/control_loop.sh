#!/bin/sh
# docs/control_loop.md: its program compiles, gives torques and refuses NaN; its table is what the calls do
# (control_loop.c); it names every status that a loop can meet, and no call that is not there.
# usage: control_loop.sh DIRECTORY_OF_RBD_H PROGRAM_OF_control_loop.c
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
    grep -q "[ *]$call(" "$root/rbd.h" "$root/rbd_derivatives.h" "$root/rbd_constraints.h" || grep -q "} $call;\|struct $call " "$root/rbd.h" || fail "there is no $call"
done
[ "$failures" -eq 0 ]
