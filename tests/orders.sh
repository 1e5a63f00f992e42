#!/bin/sh
# The headers may be included in any order and as often as one likes, before the line that defines RBD_IMPLEMENTATION
# and behind it; each that stands behind it is implemented.
# usage: orders.sh DIRECTORY_OF_RBD_H
set -u

root=${1:?usage: orders.sh DIRECTORY_OF_RBD_H}
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
checks=0
failures=0

# name LETTER: the header
name() {
    case $1 in
    r) echo rbd.h ;;
    d) echo rbd_derivatives.h ;;
    c) echo rbd_constraints.h ;;
    k) echo rbd_contact.h ;;
    s) echo rbd_spatial.h ;;
    esac
}

# file BEFORE BEHIND: letters of the headers that stand before and behind the definition
file() {
    for letter in $(echo "$1" | sed 's/./& /g'); do echo "#include \"$(name "$letter")\""; done
    [ -n "$2" ] && echo "#define RBD_IMPLEMENTATION"
    for letter in $(echo "$2" | sed 's/./& /g'); do echo "#include \"$(name "$letter")\""; done
    [ -n "$2" ] && echo "#define EXPECTED"
    case $2 in *d*) echo "#define EXPECTED_DERIVATIVES" ;; esac
    case $2 in *[ck]*) echo "#define EXPECTED_CONSTRAINTS" ;; esac
    case $2 in *k*) echo "#define EXPECTED_CONTACT" ;; esac
    case $1$2 in *d*[ck]*) echo "#define EXPECTED_BOTH" ;; esac
    case $1:$2 in *:*d*[ck]* | *d*:*[ck]*) echo "#define EXPECTED_BOTH_IMPLEMENTED" ;; esac
    cat <<'END'
#if defined EXPECTED != defined RBDI_IMPLEMENTED
#error "the implementation of rbd.h is missing, or not wanted"
#endif
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
END
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

singles="r d c k s"
pairs=
for a in $singles; do
    for b in $singles; do pairs="$pairs $a$b"; done
done
orders=$(for a in $singles; do for b in $singles; do for c in $singles; do for d in $singles; do echo "$a $b $c $d"; done; done; done; done |
    awk '$1 != $2 && $1 != $3 && $1 != $4 && $2 != $3 && $2 != $4 && $3 != $4 { print $1 $2 $3 $4 }' |
    grep r | grep d | grep s) # and c or k, which stands on it

# All orders of two on one side with one header on the other, and of four on both. tcc takes no more than a moment for each.
if command -v tcc >/dev/null 2>&1; then
    for one in "" $singles; do
        for two in "" $singles $pairs cdc; do
            compile "$one" "$two" tcc -std=c99 -c -o "$scratch/file.o"
            compile "$two" "$one" tcc -std=c99 -c -o "$scratch/file.o"
        done
    done
    for order in $orders; do compile "$order" "$order" tcc -std=c99 -c -o "$scratch/file.o"; done
fi
# The other compilers take half a second: each header stands first, and last, and either way round with each other one.
for order in rdcs dscr csrd srcd crds sdrc; do
    compile "${order#??}" "$order" "${CC:-cc}" -std=c99 -Wall -Wextra -Werror -fsyntax-only
    compile "${order#??}" "$order" "${CXX:-c++}" -std=c++17 -Wall -Wextra -Werror -fsyntax-only
done

echo "$checks checks, $failures failed"
[ "$checks" -ge 12 ] && [ "$failures" -eq 0 ]
