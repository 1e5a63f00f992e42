#!/bin/sh
# A built model (models/*_model.h) that several files include lies in the program once: in the file that implements
# rbd.h, or in the one that asks for it. Without such a file the linker names it; of another scalar it is another model.
# usage: model_link.sh DIRECTORY_OF_RBD_H
set -eu

root=$(realpath "${1:?usage: model_link.sh DIRECTORY_OF_RBD_H}")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"
failures=0
fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

cat >user.h <<'END'
#include "rbd.h"
#include "models/iiwa_model.h"
#ifdef __cplusplus
extern "C" {
#endif
int bodies(void);
const rbd_model *other(void);
#ifdef __cplusplus
}
#endif
END
# Files that use the model, in C and in C++; one that implements rbd.h; one that does not, but asks for the table, after
# it has included the declaration.
printf '#include "user.h"\nint bodies(void) { return iiwa_model.nb; }\n' >user.c
cp user.c user.cpp
printf '#include "user.h"\nint main(void) { return bodies() != 7 || &iiwa_model != other() || IIWA_WORK_SIZE < 1000; }\n' >main.c
cat >library.c <<'END'
#define RBD_IMPLEMENTATION
#include "rbd.h"
#include "user.h"
const rbd_model *other(void) { return &iiwa_model; }
END
cat >table.c <<'END'
#include "user.h"
#define IIWA_MODEL_IMPLEMENTATION
#include "user.h"
#include "models/iiwa_model.h"
const rbd_model *other(void) { return &iiwa_model; }
END
cp table.c table.cpp

cc=${CC:-cc} cxx=${CXX:-c++}
command -v "$cxx" >/dev/null || cxx=
flags="-Wall -Wextra -pedantic -Werror -O0 -Dalways_inline=unused -I$root"
# object COMPILER FILE FLAG...: warnings are errors
object() {
    compiler=$1 file=$2
    shift 2
    standard=-std=c99
    case $file in *.cpp) standard=-std=c++11 ;; esac
    # shellcheck disable=SC2086 # words wanted
    $compiler $standard $flags "$@" -c "$file" -o "$(echo "$file" | tr . _).o" || fail "$file does not compile: $*"
}
# links NAME OBJECT...: a program with each part of the model once
links() {
    name=$1
    shift
    $cc "$@" -o program -lm 2>messages || { fail "$name"; cat messages; return 0; }
    ./program || fail "$name: two models, or a wrong one"
    for part in iiwa_model_double iiwa_links iiwa_frames iiwa_dofs; do
        [ "$(nm program | grep -c "$part\$")" -eq 1 ] || fail "$name: $part stands there $(nm program | grep -c "$part\$") times"
    done
    echo "$name: done"
}

object "$cc" user.c
object "$cc" main.c
object "$cc" library.c
object "$cc" table.c
links "the file that implements rbd.h" main_c.o user_c.o library_c.o
links "a file that asks for the table" main_c.o user_c.o table_c.o
if [ -n "$cxx" ]; then
    object "$cxx" user.cpp
    object "$cxx" table.cpp
    links "C++ and C" main_c.o user_cpp.o library_c.o
    links "C and C++" main_c.o user_c.o table_cpp.o
else
    echo "left out: C++, for want of ${CXX:-c++}"
fi

printf '#include "user.h"\nconst rbd_model *other(void) { return &iiwa_model; }\n' >none.c
object "$cc" none.c
$cc main_c.o user_c.o none_c.o -o program -lm 2>messages && fail "a program without the table links"
grep -q "iiwa_model_double" messages || { fail "without the table the linker does not name it"; cat messages; }
object "$cc" table.c -DRBD_REAL=float -DRBD_CHECK_SCALAR=0
$cc main_c.o user_c.o table_c.o -o program -lm 2>messages && fail "a program with the table of another scalar links"
grep -q "iiwa_model_double" messages || { fail "of another scalar: another error"; cat messages; }

# RBD_STATIC: each file that implements has its own, and nothing for others.
object "$cc" library.c -DRBD_STATIC
[ "$(nm library_c.o | grep -c ' [rd] iiwa_model_double$')" -eq 1 ] || { fail "RBD_STATIC: the table is not static"; nm library_c.o; }

[ "$failures" -eq 0 ]
