#!/bin/sh
# `run` installs what it says, says what it leaves out, shows how far it is, and runs the suites of what changed: with
# stand-ins for apt-get, git, meson and the compilers, in a folder of its own.
# usage: run.sh DIRECTORY_OF_RUN
set -eu

root=${1:?usage: run.sh DIRECTORY_OF_RUN}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
bin=$scratch/bin
mkdir "$bin" "$scratch/tree" "$scratch/tree/tests" "$scratch/tree/tests/urdf" "$scratch/tree/tests/urdf/fuzz" \
    "$scratch/tree/tests/fuzz"
cp "$root/run" "$scratch/tree"
mkdir "$scratch/tree/bench" "$scratch/tree/tools"
cp -R "$root/tools/run" "$scratch/tree/tools"
cp "$root/bench/options.c" "$scratch/tree/bench"

fail() {
    echo "$*; it printed:"
    cat "$scratch/printed"
    exit 1
}

# stub NAME: a command whose body is standard input
stub() { { echo '#!/bin/sh'; cat; } >"$bin/$1" && chmod +x "$bin/$1"; }

# ---- a machine with nothing but a shell and a compiler ----

for tool in sh dirname env awk sed grep tr cat rm mkdir find date uname ls sleep chmod getconf wc; do
    ln -s "$(command -v "$tool")" "$bin/$tool"
done
for tool in cc c++ gcc python3; do stub "$tool" </dev/null; done
echo 'echo 1000' | stub id
stub clang++-19 <<'END'
echo /nowhere
END
# shellcheck disable=SC2016 # the stand-in expands it
echo 'echo fuzzing "$2"' >"$scratch/tree/tests/urdf/fuzz/fuzz.sh"
chmod +x "$scratch/tree/tests/urdf/fuzz/fuzz.sh"
for fuzzer in library constraints; do
    # shellcheck disable=SC2016
    printf '#!/bin/sh\necho %s "$@"\n' "$fuzzer" >"$scratch/tree/tests/fuzz/$fuzzer.sh"
    chmod +x "$scratch/tree/tests/fuzz/$fuzzer.sh"
done

# run STATUS COMMAND...: ./run, with what it prints in $scratch/printed
run() {
    expected=$1 status=0
    shift
    PATH=$bin RUN_LOCK_WAIT=0 "$scratch/tree/run" "$@" >"$scratch/printed" 2>&1 </dev/null || status=$?
    [ "$status" -eq "$expected" ] || fail "run $*: exit status $status, not $expected"
}

prints() { grep -q -e "$1" "$scratch/printed" || fail "not printed: $1"; }
prints_not() { ! grep -q -e "$1" "$scratch/printed" || fail "printed: $1"; }
asked() { grep -q -e "$1" "$scratch/apt" || { cat "$scratch/apt"; fail "apt was not asked: $1"; }; }
asked_not() { ! grep -q -e "$1" "$scratch/apt" || fail "apt was asked: $1"; }

# ---- help and unknown options, at once ----

for command in help --help bench test fuzz contact; do
    case $command in *help) set -- $command ;; *) set -- $command --help ;; esac
    run 0 "$@"
done
run 0 help
prints '^To use rbd:$'
prints '^To work on rbd '
run 0 bench --robot iiwa --help
prints '^  bench .*build and run'
prints '^  --samples N  *random states'
run 1 bench --sample 5
prints "bench has no option '--sample': ./run bench --help"
run 1 contact --test
prints "contact has no option '--test'"
run 1 tools rbd-model
prints 'tools takes no argument'
[ ! -e "$scratch/tree/build" ] || fail "something has been built"

# ---- without apt, and without root ----

run 1 deps fuss
prints 'no group fuss'
run 1 deps fuzz
prints 'please install (these are Debian.s names): pkg-config liburdfdom-dev libclang-rt-19-dev$'
run 1 fuzz
prints 'please install (these are Debian.s names): pkg-config liburdfdom-dev libclang-rt-19-dev$'
[ "$(wc -l <"$scratch/printed")" -eq 1 ] || fail "more than a line"

# It knows all packages, once its lists have been read, and sizes; what it installs appears as a command.
stub apt-get <<END
echo "\$*" >>"$scratch/apt"
case "\$*" in
*update) [ ! -e "$scratch/locked" ] || { rm "$scratch/locked"; echo "E: Could not get lock /lists/lock"; exit 100; }
         : >"$scratch/lists" ;;
*) [ -e "$scratch/lists" ] || { echo "E: Unable to locate package"; exit 100; } ;;
esac
case "\$*" in
*--assume-no*) echo "Need to get 290 MB/291 MB of archives."
               echo "After this operation, 2,212 MB of additional disk space will be used."; exit 1 ;;
*"install -y"*) for p; do case \$p in -*) ;; *) : >"$scratch/got-\$p" ;; esac; done ;;
esac
END
# shellcheck disable=SC2016
echo '[ "$1" = madison ] && [ "$2" != clang-16 ] && echo "$2 | 1.0"' | stub apt-cache
run 1 fuzz
prints 'please install, as root: apt-get install pkg-config'

# ---- as root: a size, and the patience for another apt ----

echo 'echo 0' | stub id
stub pkg-config <<END
case \$2 in pinocchio) [ -e "$scratch/pinocchio" ] ;; *) [ -e "$scratch/got-liburdfdom-dev" ] ;; esac
END
: >"$scratch/locked"
: >"$scratch/apt"
run 0 fuzz 7
prints 'installing liburdfdom-dev libclang-rt-19-dev$'
prints '290 MB/291 MB to fetch, 2,212 MB on disk'
prints '^fuzzing 7$'
for fuzzer in library constraints; do
    run 0 fuzz "--$fuzzer" 7 --publish
    prints "^$fuzzer .*/build/fuzz 7 --publish\$"
done
asked 'Lock::Timeout=[1-9].* install -y .*liburdfdom-dev libclang-rt-19-dev$'
asked_not 'clang-19 '
[ "$(grep -c 'update$' "$scratch/apt")" -eq 2 ] || fail "the lists were not read again when they were locked"

# ---- the tests: all, light, and a build that fails ----

stub ninja <<END
for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do echo "[\$i/20] Compiling \$i.c"; done
[ ! -e "$scratch/broken" ] || { echo "error: 20.c is wrong"; exit 1; }
END
stub meson <<END
echo "\$* CXX=\${CXX-}" >>"$scratch/meson"
case "\$*" in
*--list*--suite\ packages*) echo "rbd:packages / package cmake" ;;
*--list*--suite\ firmware*) echo "rbd:firmware / firmware cortex-m3" ;;
*--list*--suite\ machines*) echo "rbd:machines / machine s390x" ;;
*--list*) echo "rbd / suites"; echo "rbd / scalar float" ;;
test*) mkdir -p "$scratch/tree/build/meson-logs"
       cat "$scratch/skipped" >"$scratch/tree/build/meson-logs/testlog.txt"
       printf 'Ok:                 3\nFail:               0\n' >>"$scratch/tree/build/meson-logs/testlog.txt" ;;
esac
END
# The log of two tests that are skipped, as meson writes it.
cat >"$scratch/skipped" <<'END'
=================================== 1/3 ===================================
test:         plot
result:       exit status 77
command:      check_plot.sh
--------------------------------- stdout ----------------------------------
skipped: there is no gnuplot
===========================================================================
=================================== 2/3 ===================================
test:         counters
result:       exit status 77
command:      counters
--------------------------------- stderr ----------------------------------
a line
its last line
===========================================================================
=================================== 3/3 ===================================
test:         suites
result:       exit status 0
--------------------------------- stdout ----------------------------------
a line
===========================================================================
END
: >"$scratch/apt"
run 0 test --light suites -v
prints "^run: test takes .* min .* or so: [0-9]* min of a processor on $(getconf _NPROCESSORS_ONLN) cores\$"
prints '^3 passed, 0 failed$'
prints '^left out: plot: there is no gnuplot$'
prints '^left out: counters: its last line$'
prints '^left out: package cmake$'
prints '^left out: firmware cortex-m3$'
prints '^left out: machine s390x$'
prints '^not installed for --light: gcc-arm-none-eabi$'
prints 'built 20 of 20$'
[ "$(grep -c 'run: built' "$scratch/printed")" -eq 10 ] || fail "not a line for each tenth"
asked_not 'arm-none-eabi'
asked_not 'install.* cmake'
grep -q -e 'test .*--no-suite machines --no-suite firmware --no-suite packages suites -v CXX=$' "$scratch/meson" || fail "wrong meson arguments"

# Names of no test and unknown options are refused before anything is built; patterns and values of options are neither.
: >"$scratch/skipped"
run 1 test --light suitse
prints "no test is called 'suitse'"
prints_not 'built'
run 0 test --light 'scalar*' --repeat 3 rbd:suites
prints 'built 20 of 20$'

# The time of named tests is not that of all. It says how long all took when they ran here.
[ ! -e "$scratch/tree/build/.took-light" ] || fail "the time of some tests was kept"
run 0 test --light
run 0 test --light
prints '^run: test takes [0-9]* s, as the last time here$'

# A name may be new in a meson.build: the list of tests is made anew before a name is refused.
touch "$scratch/tree/build/build.ninja"
touch -d '1 minute' "$scratch/tree/tests/meson.build"
run 1 test --light suitse
prints "no test is called 'suitse'"
prints 'built'
rm "$scratch/tree/tests/meson.build" "$scratch/tree/build/build.ninja"

run 0 test
asked 'install -y .* cmake$'
asked 'install -y .*clang-19.* clang-format-19.* gcc-arm-none-eabi'
asked_not 'install.*clang-16'
prints 'doing without clang-16'
prints_not 'left out'
grep -q 'setup.* CXX=$' "$scratch/meson" || fail "another C++ compiler than the usual"
# clang compiles C++ where Pinocchio is, unless CXX says another.
: >"$scratch/pinocchio"
run 0 test
grep -q 'setup.* CXX=clang++-19$' "$scratch/meson" || fail "Pinocchio is not compiled by clang"
rm "$scratch/pinocchio"
tail -n 1 "$scratch/meson" | grep -q 'print-errorlogs CXX=$' || fail "arguments of another run"

: >"$scratch/broken"
run 1 test --light
prints 'error: 20.c is wrong'
prints '^run: failed: ninja'
prints_not 'passed'
rm "$scratch/broken"

# ---- what is built stays when something has been installed since; that of another tree does not ----

tools=$scratch/tree/build/tools/rbd-model
mkdir -p "${tools%/*}"
: >"$tools" >"$scratch/tree/build/build.ninja"
run 0 test --light # configures, since the last one failed
: >"$scratch/meson"
stub clang-16 </dev/null # comes
run 0 test --light
prints 'configuring build/ again, since something has been installed or removed$'
[ -e "$tools" ] || fail "build/tools is gone"
grep -q '^configure .*--clearcache CXX=$' "$scratch/meson" && grep -q '^setup --reconfigure ' "$scratch/meson" || fail "wrong meson arguments"
run 0 test --light
prints_not 'configuring'
sed -i '1s|.*|/another/tree|' "$scratch/tree/build/.run"
run 0 test --light
prints 'configuring build/$'
[ ! -e "$tools" ] || fail "build/tools of another tree stayed"

# ---- two commands do not work in build/ at once ----

# It ends when the file is there.
stub meson <<END
case "\$*" in
*--list*) echo "rbd / suites" ;;
test*) while [ ! -e "$scratch/end" ]; do sleep 0.1; done
       mkdir -p "$scratch/tree/build/meson-logs"
       printf 'Ok:                 3\nFail:               0\n' >"$scratch/tree/build/meson-logs/testlog.txt" ;;
esac
END
PATH=$bin RUN_LOCK_WAIT=0.1 "$scratch/tree/run" test --light >"$scratch/first" 2>&1 </dev/null &
first=$!
while [ ! -e "$scratch/tree/build/.lock/holder" ]; do sleep 0.1; done
PATH=$bin RUN_LOCK_WAIT=0.1 "$scratch/tree/run" tools >"$scratch/printed" 2>&1 </dev/null &
second=$!
until grep -q waiting "$scratch/printed"; do sleep 0.1; done
prints "waiting: ./run test (process $first) works in build/; if not, remove build/.lock\$"
prints_not 'built'
: >"$scratch/end"
wait "$first" || fail "the first of two commands"
wait "$second" || fail "the second of two commands"
prints 'build/tools/rbd-model$'
[ ! -e "$scratch/tree/build/.lock" ] || fail "the lock stayed"

# The lock of a process that is no more does not count.
mkdir "$scratch/tree/build/.lock"
echo "$first test" >"$scratch/tree/build/.lock/holder"
run 0 tools
prints_not 'waiting'

# ---- quick: the suites of what changed ----

mkdir -p "$scratch/tree/src/dynamics" "$scratch/tree/src/contact"
cp "$root/src/headers.txt" "$scratch/tree/src"
: >"$scratch/tree/src/dynamics/aba.h"
: >"$scratch/tree/src/contact/rows.h"
printf '#define SUITES(x) x(aba) x(crba) x(contact) x(contact_step)\n' >"$scratch/tree/tests/suites.h"
for suite in aba crba contact contact_step batch sincos spatial; do : >"$scratch/tree/tests/test_$suite.c"; done
ln -sf "$(python3 -c "import sys; print(sys.executable)")" "$bin/python3"
stub clang-format-19 <<END
echo "formatted \$*" >>"$scratch/order"
END
stub git <<END
case \$* in diff*) cat "$scratch/changed" ;; esac
END
stub meson <<END
echo "configured \$*" >>"$scratch/order"
mkdir -p "$scratch/tree/build-quick/tests"
: >"$scratch/tree/build-quick/build.ninja"
printf '#!/bin/sh\necho "ran \$*"\n[ ! -e "$scratch/wrong" ]\n' >"$scratch/tree/build-quick/tests/tests"
for other in batch_double__2_lanes sincos_double spatial_double qp_double; do
    printf '#!/bin/sh\necho "ran %s"\n' \$other >"$scratch/tree/build-quick/tests/\$other"
done
chmod +x "$scratch/tree/build-quick/tests/"*
END
stub ninja <<END
echo "built \$3" >>"$scratch/order"
END
printf '#!/bin/sh\necho amalgamated >>"%s"\n' "$scratch/order" >"$scratch/tree/src/amalgamate.py"
chmod +x "$scratch/tree/src/amalgamate.py"

# A misspelt suite is refused at once.
run 1 quick abba
prints "no suite is called 'abba'; did you mean 'aba'?"
[ ! -e "$scratch/tree/build-quick" ] || fail "something has been built for no suite"

# The room's own suite; its storey's. What changed is formatted before the headers are made, the headers themselves not.
printf 'src/dynamics/aba.h\nrbd.h\ndocs/tools.md\n' >"$scratch/changed"
run 0 quick
prints '^ran aba$'
printf 'formatted -i src/dynamics/aba.h\namalgamated\n' >"$scratch/expected"
sed -n 1,2p "$scratch/order" | cmp -s - "$scratch/expected" || { cat "$scratch/order"; fail "formatting comes after"; }
grep -q '^configured setup .*/build-quick .*-Doptimization=0' "$scratch/order" || fail "wrong configuration"
prints 'run: quick took .* of processor time'
echo src/contact/rows.h >"$scratch/changed"
run 0 quick
prints 'ran contact contact_step$'

# Nothing changed, as in a fresh clone: every suite. A new call's symbol: those of its test.
: >"$scratch/changed"
run 0 quick
prints 'nothing in src/ or tests/ has changed since the last commit: every suite, without its slow tests'
prints 'ran aba crba contact contact_step$'
printf 'src/api/symbols.h\ntests/test_crba.c\n' >"$scratch/changed"
run 0 quick
prints 'ran crba$'

# Named suites, all, and one that fails. It is configured once.
run 0 quick crba
prints 'ran crba$'
run 0 test --quick
prints 'ran aba crba contact contact_step$'
prints 'ran spatial_double$'
[ "$(grep -c configured "$scratch/order")" -eq 1 ] || fail "configured more than once"
: >"$scratch/wrong"
run 1 quick crba
