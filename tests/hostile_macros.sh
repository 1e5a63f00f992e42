#!/bin/sh
# rbd.h compiles whatever macros are there before it: those of every ISO C and POSIX header, and those of Arduino,
# newlib, Zephyr, CMSIS, Windows and whoever has a constant of one letter; they are the caller's again behind it.
# In C and C++, single calls and batches, with the built models, rbd_spatial.h, and for rbd_urdf.h and rbd_mjcf.h the
# declarations.
# usage: hostile_macros.sh DIRECTORY_OF_RBD_H   by gcc and clang++-19; with RBD_ALL_TESTS=yes by g++ and clang-19 too
set -u

root=${1:?usage: hostile_macros.sh DIRECTORY_OF_RBD_H}
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
checks=0
failures=0
missing=

iso="assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign stdarg stdatomic
    stdbool stddef stdint stdio stdlib stdnoreturn string tgmath threads time uchar wchar wctype"
posix="aio arpa/inet cpio dirent dlfcn fcntl fmtmsg fnmatch ftw glob grp iconv langinfo libgen monetary mqueue ndbm
    net/if netdb netinet/in netinet/tcp nl_types poll pthread pwd regex sched search semaphore spawn strings stropts
    sys/ipc sys/mman sys/msg sys/param sys/resource sys/select sys/sem sys/shm sys/socket sys/stat sys/statvfs sys/time
    sys/times sys/types sys/uio sys/un sys/utsname sys/wait syslog tar termios trace ulimit unistd utime utmpx
    wordexp"

# What no identifier of ours may be, with a value that no code survives.
hostile_names() {
    echo A B C D E F G H I J K L M N O P Q R S T U V W X Y Z
    echo PI HALF_PI TWO_PI DEG_TO_RAD RAD_TO_DEG EULER HIGH LOW INPUT OUTPUT INPUT_PULLUP DEFAULT EXTERNAL INTERNAL \
        INTERNAL1V1 CHANGE RISING FALLING LSBFIRST MSBFIRST SERIAL DISPLAY # Arduino
    echo _C _N _U _L _S _P _B _X                                           # newlib's ctype.h
    echo __I __O __IO __IM __OM __IOM __STATIC_INLINE __WEAK __PACKED      # CMSIS
    echo SET RESET ENABLE DISABLE ERROR SUCCESS BUSY IDLE READY LOCK UNLOCK PS SP PC LR SR CR BR SAR EPS GPIO TIM UART
    echo E0 E1 Q0 R0 R1 OK ERR FAIL PASS TRUE FALSE ON OFF YES NO FLOAT REAL DOUBLE INT BOOL BYTE VERSION DEBUG INFO \
        WARNING SIZE LENGTH COUNT NONE ALL ROOT WORLD FRAME LINK JOINT AXIS MASS BLOCK GRAVITY G0 DT DOF NQ NV NB
    echo small near far interface hyper IN OUT OPTIONAL CONST VOID unix linux # Windows and GNU
}
hostile_functions() {
    echo min max abs round constrain radians degrees sq bit bitRead bitSet bitClear bitWrite lowByte highByte F \
        interrupts noInterrupts word boolean                               # Arduino
    echo MIN MAX BIT BIT_MASK ARRAY_SIZE CLAMP CONTAINER_OF ROUND_UP ROUND_DOWN CEIL DIV_ROUND_UP IN_RANGE CONCAT \
        STRINGIFY UTIL_CAT LIST_DROP_EMPTY ARG_UNUSED ABS POW2 SWAP LERP SQUARE SIGN # Zephyr and others
}

{
    echo '#include <stddef.h>'
    echo '#include <stdint.h>'
    echo '#include <stdlib.h>'
    echo '#include <math.h>'
    for name in $(hostile_functions); do printf '#undef %s\n#define %s(...) ]hostile[\n' "$name" "$name"; done
    for name in $(hostile_names); do printf '#undef %s\n#define %s ]hostile[\n' "$name" "$name"; done
    awk 'BEGIN { # B0 to B11111111
        for (n = 1; n <= 8; n++)
            for (i = 0; i < 2 ^ n; i++) {
                bits = ""
                for (k = n - 1; k >= 0; k--) bits = bits int(i / 2 ^ k) % 2
                print "#define B" bits " ]hostile["
            }
    }'
    printf '#undef I\n#define I 42\n'
} >"$scratch/hostile.h"
cat >"$scratch/behind.h" <<'END'
#if I != 42 || !defined F || !defined E || !defined J
#error "the caller's macros are gone"
#endif
static unsigned char bytes[RBD_MODEL_SIZE(2) + RBD_WORK_SIZE(2, 2) + RBD_WORK_SIZE_MIMIC(2, 2) + RBD_DERIVATIVES_SIZE(2, 2) + RBD_IK_SIZE(2, 2, 2)];
rbd_status use(void);
rbd_status use(void) {
    bytes[0] = 1;
    return rbd_set_gravity(NULL, NULL);
}
END
# Every shipped header, but that of batches.
all_headers() { grep -v batch "$root/src/headers.txt" | sed 's/.*/#include "&"/'; }

{
    printf '#include "hostile.h"\n#define RBD_IMPLEMENTATION\n'
    all_headers
    printf '#include "%s"\n' models/iiwa_model.h behind.h rbd_spatial.h rbd_urdf.h rbd_mjcf.h
} >"$scratch/hostile.c"
cat >"$scratch/hostile_batch.c" <<'END'
#include "hostile.h"
#define RBD_LANES 4
#define RBD_BATCH_IMPLEMENTATION
#include "rbd_derivatives.h"
#include "rbd_constraints.h"
#include "rbd_batch.h"
END

# compile FILE COMPILER FLAG...
compile() {
    file=$1
    shift
    checks=$((checks + 1))
    "$@" -Wall -Wextra -Werror -Wno-psabi -I"$root" -fsyntax-only "$scratch/$file.c" 2>"$scratch/messages" && return
    failures=$((failures + 1))
    echo "FAILED: $*: $file.c"
    sed -n '1,10p' "$scratch/messages"
}

# after_headers COMPILER FLAG...: those that there are, all in one file
after_headers() {
    for header in $iso $posix; do
        printf '#if __has_include(<%s.h>)\n#include <%s.h>\n#else\n#pragma message "absent: %s"\n#endif\n' \
            "$header" "$header" "$header"
    done >"$scratch/headers.c"
    {
        echo '#define RBD_IMPLEMENTATION'
        all_headers
        printf '#include "rbd_urdf.h"\n#include "rbd_mjcf.h"\n'
    } >>"$scratch/headers.c"
    compile headers "$@" -Wno-error=cpp -Wno-cpp
    absent=$(sed -n 's/.*absent: \([a-z0-9/]*\)[^a-z0-9/].*/\1/p' "$scratch/messages" | sort -u | xargs)
    echo "$1: not there: ${absent:-none}"
    [ "$(echo "$absent" | wc -w)" -lt 20 ] || failures=$((failures + 1))
}

compilers="gcc clang++-19"
if [ -n "${RBD_ALL_TESTS-}" ]; then
    compilers="gcc g++ clang-19 clang++-19"
else
    echo "SKIPPED but by ./run test --all: g++ and clang-19"
fi
for compiler in $compilers; do
    if ! command -v "$compiler" >/dev/null 2>&1; then
        missing="$missing $compiler"
        continue
    fi
    case $compiler in
    *++*) set -- "$compiler" -x c++ -std=gnu++17 ;;
    *) set -- "$compiler" -x c -std=gnu11 ;;
    esac
    after_headers "$@" -D_GNU_SOURCE
    compile hostile "$@"
    compile hostile_batch "$@"
done

echo "$checks checks, $failures failed; missing:${missing:- nothing}"
[ "$checks" -gt 0 ] && [ "$failures" -eq 0 ]
