#!/bin/sh
# The headers may be included in any order and as often as one likes, before the line that defines RBD_IMPLEMENTATION
# and behind it; each that stands behind it is implemented. rbd_batch.h has the batch calls of the headers before it.
# usage: orders.sh DIRECTORY_OF_RBD_H   with RBD_ALL_TESTS=yes also one header before two behind and two before one,
#     rbd_contact.h in each order of four, and each order of C++ and of batches
set -u

root=${1:?usage: orders.sh DIRECTORY_OF_RBD_H}
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
checks=0
failures=0

# includes LETTERS: the headers' lines
includes() {
    letters=$1
    while [ -n "$letters" ]; do
        case $letters in
        r*) echo '#include "rbd.h"' ;;
        d*) echo '#include "rbd_derivatives.h"' ;;
        c*) echo '#include "rbd_constraints.h"' ;;
        k*) echo '#include "rbd_contact.h"' ;;
        b*) echo '#include "rbd_batch.h"' ;;
        s*) echo '#include "rbd_spatial.h"' ;;
        i*) echo '#include "rbd_ik.h"' ;;
        e*) echo '#include "rbd_estimate.h"' ;;
        a*) echo '#include "rbd_actuator.h"' ;;
        q*) echo '#include "rbd_qp.h"' ;;
        t*) echo '#include "rbd_tasks.h"' ;;
        esac
        letters=${letters#?}
    done
}

# Judges what EXPECTED_... say.
cat >"$scratch/judge.h" <<'END'
#if defined EXPECTED_DERIVATIVES && !defined RBDI_DERIVATIVES_IMPLEMENTED
#error "the implementation of rbd_derivatives.h is missing"
#endif
#if defined EXPECTED_CONSTRAINTS && !defined RBDI_CONSTRAINTS_IMPLEMENTED
#error "the implementation of rbd_constraints.h is missing"
#endif
#if defined EXPECTED_CONTACT && !defined RBDI_CONTACT_IMPLEMENTED
#error "the implementation of rbd_contact.h is missing"
#endif
#if defined EXPECTED_BOTH_IMPLEMENTED && !defined RBDI_CONSTRAINED_DERIVATIVES_IMPLEMENTED
#error "the implementation of the derivatives of constrained dynamics is missing"
#endif
#if defined EXPECTED_BOTH
void use(void);
void use(void) { (void)rbd_constrained_fd_derivatives; }
#endif
#if defined EXPECTED_CONTACT_DERIVATIVES
void use_contact(void);
void use_contact(void) { (void)rbd_contact_step_derivatives; }
#endif
#if defined NOT_EXPECTED_CONSTRAINTS && (defined RBDI_CONSTRAINTS_IMPLEMENTED || \
                                         defined RBDI_CONSTRAINED_DERIVATIVES_IMPLEMENTED)
#error "an implementation of rbd_constraints.h that is not wanted"
#endif
#if defined EXPECTED_BATCH_DERIVATIVES
void use_derivatives(void);
void use_derivatives(void) { (void)rbd_batch_id_derivatives; }
#endif
#if defined EXPECTED_BATCH_CONSTRAINTS
void use_constraints(void);
void use_constraints(void) { (void)rbd_batch_constrained_fd; }
#endif
END

# expect MACRO PATTERN BEHIND: the macro is there if the letters behind the definition match the pattern, and else not.
expect() {
    # shellcheck disable=SC2254 # a pattern is wanted
    case $3 in
    $2) echo "#ifndef $1" ;;
    *) echo "#ifdef $1" ;;
    esac
    printf '#error "%s is missing, or not wanted"\n#endif\n' "$1"
}

# file BEFORE BEHIND: letters of the headers that stand before and behind the definition
file() {
    includes "$1"
    [ -n "$2" ] && echo "#define RBD_IMPLEMENTATION"
    includes "$2"
    case $2 in *[de]*) echo "#define EXPECTED_DERIVATIVES" ;; esac
    expect RBDI_IMPLEMENTED '*[rdckbsieat]*' "$2"
    expect RBDI_QP_IMPLEMENTED '*[qt]*' "$2"
    expect RBDI_IK_IMPLEMENTED '*[it]*' "$2"
    expect RBDI_ESTIMATE_IMPLEMENTED '*e*' "$2"
    expect RBDI_TASKS_IMPLEMENTED '*t*' "$2"
    expect RBDI_ACTUATOR_IMPLEMENTED '*a*' "$2"
    case $2 in *[ck]*) echo "#define EXPECTED_CONSTRAINTS" ;; esac
    case $2 in *k*) echo "#define EXPECTED_CONTACT" ;; esac
    case $1$2 in *[de]*[ck]* | *[ck]*[de]*) echo "#define EXPECTED_BOTH" ;; esac
    case $1$2 in *[de]*k* | *k*[de]*) echo "#define EXPECTED_CONTACT_DERIVATIVES" ;; esac
    case $1$2 in *[de]*b*) echo "#define EXPECTED_BATCH_DERIVATIVES" ;; esac
    case $1$2 in *[ck]*b*) echo "#define EXPECTED_BATCH_CONSTRAINTS" ;; esac
    case $1:$2 in *:*[ck]*[de]* | *[de]*:*[ck]* | *:*[de]*[ck]*) echo "#define EXPECTED_BOTH_IMPLEMENTED" ;; esac
    case $2 in *[ck]*) ;; *) echo "#define NOT_EXPECTED_CONSTRAINTS" ;; esac
    echo '#include "judge.h"'
}

# compile BEFORE BEHIND COMPILER FLAG...
compile() {
    before=$1
    behind=$2
    shift 2
    checks=$((checks + 1))
    file "$before" "$behind" >"$scratch/file.c"
    "$@" -I"$root" "$scratch/file.c" >"$scratch/messages" 2>&1 && return
    failures=$((failures + 1))
    echo "FAILED: $*: before: $before, behind: $behind"
    sed -n '1,5p' "$scratch/messages"
}

# implements HEADERS NUMBER COMPILER FLAG...: a file of batches, which defines so many of their calls
implements() {
    headers=$1
    number=$2
    shift 2
    checks=$((checks + 1))
    {
        printf '#define RBD_LANES 2\n#define RBD_BATCH_IMPLEMENTATION\n'
        includes "$headers"
    } >"$scratch/file.c"
    "$@" -Dalways_inline=unused -I"$root" -c "$scratch/file.c" -o "$scratch/file.o" >"$scratch/messages" 2>&1 &&
        [ "$(nm "$scratch/file.o" | grep -c ' T rbd_batch_')" -eq "$number" ] && return
    failures=$((failures + 1))
    echo "FAILED: $*: batches of $headers"
    sed -n '1,5p' "$scratch/messages"
}

# Each header meets each other one; the four of the core, of which some stand on others, meet in pairs too.
singles="r d c k s b q i e a t"
core="r d c k"
pairs=
for a in $core; do
    for b in $core; do pairs="$pairs $a$b"; done
done
orders=$(for a in r d c k s; do for b in r d c k s; do for c in r d c k s; do for d in r d c k s; do echo "$a $b $c $d"; done; done; done; done |
    awk '$1 != $2 && $1 != $3 && $1 != $4 && $2 != $3 && $2 != $4 && $3 != $4 { print $1 $2 $3 $4 }' |
    grep r | grep d | grep s) # and c or k, which stands on it
all=${RBD_ALL_TESTS-}
if [ -z "$all" ]; then
    orders=$(echo "$orders" | grep c)
    echo "SKIPPED but by ./run test --all: one header before two and two before one, rbd_contact.h in each order of four, some of C++"
fi

# tcc takes no more than a moment for each.
if command -v tcc >/dev/null 2>&1; then
    for one in "" $singles; do
        for two in "" $singles; do compile "$one" "$two" tcc -std=c99 -c -o "$scratch/file.o"; done
    done
    for two in $pairs; do
        compile "" "$two" tcc -std=c99 -c -o "$scratch/file.o"
        [ -n "$all" ] || continue
        compile "$two" "" tcc -std=c99 -c -o "$scratch/file.o"
        for one in $core; do
            compile "$one" "$two" tcc -std=c99 -c -o "$scratch/file.o"
            compile "$two" "$one" tcc -std=c99 -c -o "$scratch/file.o"
        done
    done
    for two in bs sb cdc dcb bdcb; do compile "" "$two" tcc -std=c99 -c -o "$scratch/file.o"; done
    for order in $orders; do compile "${order#??}" "$order" tcc -std=c99 -c -o "$scratch/file.o"; done
fi
# The other compilers take a quarter of a second: in C++ with --all each header stands first, and last, and either way round
# with each other one; else each stands first or last. In C, which tcc compiles above, a few for what they warn of.
cpp_orders="rdcs csrd kidq akdr tkqi" c_orders="csrd tkqi"
batches="bb bdb cbdb"
if [ -n "$all" ]; then
    cpp_orders="rdcs csrd sdrc qkdr kqds ikdr kids akdr kads tkqi qkdt" c_orders="csrd kids akdr tkqi"
    batches="b rb bb db bdb cbdb dcb"
fi
for order in $cpp_orders; do
    compile "${order#??}" "$order" "${CXX:-c++}" -x c++ -std=c++17 -Wall -Wextra -Werror -fsyntax-only
done
for order in $c_orders; do
    compile "${order#??}" "$order" "${CC:-cc}" -std=c99 -Wall -Wextra -Werror -fsyntax-only
done
if [ -n "$("${CC:-cc}" -dM -E -x c /dev/null | grep __GNUC__)" ]; then # has lanes
    for batch in $batches; do
        case $batch in *c*) calls=25 ;; *d*) calls=22 ;; *) calls=15 ;; esac
        implements "$batch" $calls "${CC:-cc}" -std=c99 -Wall -Wextra -Werror
    done
    implements cbdb 25 "${CXX:-c++}" -x c++ -std=c++11 -Wall -Wextra -Werror
fi

echo "$checks checks, $failures failed"
[ "$checks" -ge 12 ] && [ "$failures" -eq 0 ]
