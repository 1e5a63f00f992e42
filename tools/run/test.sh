# ./run test. Sourced by ../../run. "#: " lines are the help.
# shellcheck shell=sh disable=SC2154 # run sets root and parts

# Groups of packages.txt that ./run test cannot do without; with --light; and those that it leaves out where they are not
# to be had.
test_groups='build test packages'
light_groups='build test'
test_options='compilers coverage firmware machines format site web browser'
# The suites of meson.build that --light leaves out.
heavy_suites='packages firmware machines web'

# Processor time from nothing, in seconds, of the tests, of --light and of --all, on two cores of a
# Xeon in November 2026.
seconds_of() {
    case $1 in light) echo 520 ;; all) echo 2000 ;; *) echo 605 ;; esac
}

# say_expected KIND: how long this takes here, as the last time did, or by its processor time
say_expected() {
    took=$build/.took-$1 seconds=$(seconds_of "$1") cores=$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 2)
    if [ -f "$took" ]; then
        takes "$(in_words "$(cat "$took")"), as the last time here"
    else
        takes "$(in_words $((seconds / cores))) or so: $((seconds / 60)) min of a processor on $cores cores"
    fi
}

# Configures the build for the tests of this kind: all, or those of every day. What is built stays.
choose_tests() {
    wanted=false
    [ "$1" != all ] || wanted=true
    before=$(sed -n 's/^all_tests = //p' "$build/meson-private/cmd_line.txt" 2>/dev/null)
    [ "${before:-false}" = $wanted ] || quietly meson configure "$build" -Dall_tests=$wanted
}

# Keeps how long this took, for the next time.
keep_time() { echo $(($(date +%s) - started)) >"$build/.took-$1"; }

# refuse_unknown_tests ARGUMENT...: of meson test, those that are names of no test, and what meson does not know
refuse_unknown_tests() {
    names=$(meson test -C "$build" --no-rebuild --list 2>/dev/null | sed 's|.* / ||')
    value=
    for argument; do
        [ -z "$value" ] || { value=; continue; }
        case $argument in
        --maxfail | --repeat | --gdb-path | --wrapper | -C | --suite | --no-suite | --logbase | -j | --num-processes | \
            -t | --timeout-multiplier | --setup | --test-args | --max-lines) value=yes ;;
        -*) ;;
        *) printf '%s\n' "$names" | {
               while read -r name; do
                   # shellcheck disable=SC2254 # meson takes patterns
                   case $name in $argument | ${argument#*:}) exit 0 ;; esac
               done
               exit 1
           } || die "no test is called '$argument'$(printf '%s\n' "$names" | nearest "$argument")" \
               "All names: meson test -C build --list" ;;
        esac
    done
    wrong=$(meson test -C "$build" --no-rebuild --list "$@" 2>&1 >/dev/null) ||
        die "meson test: ${wrong:+"${wrong##*meson: error: }; "}./run test --help, or meson test -C build --list"
}

# Whether a meson.build is newer than the list of tests, so that a name may be new.
tests_may_be_new() {
    [ -e "$build/build.ninja" ] || return 1
    find "$root" -path "$root/build*" -prune -o -name node_modules -prune -o -path "$root/.git" -prune -o \
        -name meson.build -newer "$build/build.ninja" -print | grep -q .
}

# The names of the tests in the suites given.
tests_of() {
    for suite; do
        meson test -C "$build" --no-rebuild --list --suite "$suite" 2>/dev/null | sed -n 's|^rbd:[^/]* / ||p'
    done
}

# summary_of LOG: what meson counts, and what was left out and why. Ok and expected failures have passed; skipped tests
# are neither.
summary_of() {
    awk '/^(Ok|Expected Fail): +[0-9]+/ { passed += $NF }
         /^(Fail|Unexpected Pass|Timeout): +[0-9]+/ { failed += $NF }
         /^====/ && skipped { print "left out: " skipped reason; skipped = reason = "" }
         skipped && /[a-z]/ && !/^(command:|---)/ { reason = ": " $0; sub(/^: (skipped|left out): /, ": ", reason) }
         /^test: / { test = $0; sub(/^test: +/, "", test) }
         /^result: .* 77/ { skipped = test }
         /^SKIPPED / { print "left out of " test ": " $0 }
         /failed; missing: / && !/missing: nothing/ { sub(/.*missing:/, ""); print "left out of " test ":" $0 }
         END { printf "%d passed, %d failed\n", passed, failed }' "$1"
}

# run_tests ARGUMENT...: of what is built, by meson test
run_tests() {
    testlog=$build/meson-logs/testlog.txt
    rm -f "$testlog"
    meson test -C "$build" --no-rebuild --print-errorlogs "$@"
    status=$?
    [ -f "$testlog" ] || die "meson test did not run"
    return $status
}

# Installs what the tests need: all of it, or for --light.
install_for_tests() {
    # shellcheck disable=SC2086 # words wanted
    if [ "$1" = light ]; then
        install $light_groups
    else
        install $test_groups
        install_optional $test_options
        [ "$1" != all ] || install_optional windows
    fi
}

#: test [--light] [OPTION...]  build and run the tests, of the microcontrollers three (all: firmware);
#:                             --light: without the cross compilers and packages, which take gigabytes of
#:                             disk; further options are meson test's
#: test --all [OPTION...]      also the tests and parts of tests that take long for what they add: coverage, the playground,
#:                             second compilers, scalars and machines; before a release
#: test --quick                the suites alone, in double, in a minute
cmd_test() {
    kind=test
    for argument; do
        shift
        case $argument in
        --light) kind=light ;;
        --all) kind=all ;;
        --quick) cmd_quick all; return ;;
        *) set -- "$@" "$argument" ;;
        esac
    done
    prepare
    [ ! -e "$build/build.ninja" ] || tests_may_be_new || refuse_unknown_tests "$@" # at once
    install_for_tests $kind
    some=$*
    if [ $kind = light ]; then
        for suite in $heavy_suites; do set -- --no-suite "$suite" "$@"; done
    fi
    bench_optimization=g bench_peers=disabled
    take_lock
    configure
    choose_tests $kind
    ! tests_may_be_new || compile build.ninja
    refuse_unknown_tests "$@"
    say_expected $kind
    bring_up all meson-test-prereq
    run_tests "$@"
    status=$?
    # shellcheck disable=SC2086 # words wanted
    [ $kind != light ] || {
        tests_of $heavy_suites | sed 's/^/left out: /'
        missing $test_options | sed 's/^/not installed for --light: /'
    }
    summary_of "$testlog"
    [ -n "$some" ] || keep_time $kind
    return $status
}
