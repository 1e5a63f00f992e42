# The commands, but test and quick. Sourced by ../../run. "#: " lines are the help for users, "#+ " lines for contributors.
# shellcheck shell=sh disable=SC2154 # run sets root and parts

#: bench [--peers] [OPTION...] build and run the benchmark; options are rbd-bench's;
#:                             with --peers MuJoCo and KDL are installed, to be measured beside rbd
cmd_bench() {
    prepare
    install build
    for argument; do
        shift
        case $argument in --peers) install_optional peers ;; *) set -- "$@" "$argument" ;; esac
    done
    ! have_pinocchio || install_optional clang
    [ -x "$build/bench/rbd-bench" ] || say "run: compiling it the first time takes two minutes or so on two cores," \
        "with Pinocchio five; rbd-bench then says how long it times"
    bring_up bench/rbd-bench
    note=
    case " $*" in
    *" --samples"*) ;;
    *) set -- --samples 10000 "$@"
       note="run: a tenth of the samples; the full method: ./run bench --samples 100000" ;;
    esac
    "$build/bench/rbd-bench" "$@" || exit
    [ -z "$note" ] || say "$note"
}

#: tools                       build rbd-model, rbd-codegen and rbd-eval, and say where they are
cmd_tools() {
    prepare
    install build
    bring_up tools/rbd-model tools/rbd-codegen tools/rbd-eval
    printf '%s\n' "$build/tools/rbd-model" "$build/tools/rbd-codegen" "$build/tools/rbd-eval"
}

#+ instructions [OPTION...]    count instructions per call (x86-64)
cmd_instructions() {
    case $(uname -m) in
    x86_64 | amd64) ;;
    *) die "instructions are counted on x86-64 only: -march=haswell" ;;
    esac
    prepare
    install build count
    install_optional clang
    bring_up tools/rbd-codegen
    takes "six minutes or so on two cores"
    "$root/bench/counters/instructions.sh" "$build" "$@"
}

#+ report [OPTION...]          measure, count and draw all of it: a page of figures; first the tests of the peers and of
#+                             the report
cmd_report() {
    prepare
    install build report
    install_optional peers
    takes "five to ten minutes on two cores, most of them to compile; with Pinocchio twice as long, with its code thrice"
    bring_up tools/rbd-codegen # whose configure drops the report's builds if something has come
    quietly meson configure "$build" -Dpeers=auto -Dreport_tests=true
    meson test -C "$build" --suite report --suite bench --print-errorlogs || die "a test of the report fails"
    python3 "$root/bench/workload/report.py" "$@"
}

#: contact [FOLDER]            steps with contacts beside MuJoCo: time, count, judge and draw them, into
#:                             build/contact or the folder
#+ contact --tests             the tests of contacts with their numbers, what was found beside what is expected; the
#+                             instructions are those of bench/results
cmd_contact() {
    prepare
    if [ "${1-}" = --tests ]; then
        install build
        bring_up tests/tests tests/contact_float
        "$build/tests/tests" --contacts && "$build/tests/contact_float" && python3 "$root/bench/contact/report.py" --instructions
        return
    fi
    install build report peers
    takes "three minutes or so"
    bring_up bench/contact bench/contact-haswell
    python3 "$root/bench/contact/report.py" "$build/bench" "${1-$build/contact}"
}

#+ fuzz [SECONDS]              feed broken URDF files to the loader, for a minute or so long; needs clang
#+ fuzz --library [SECONDS]    random robots against quad precision and the bounds of docs/accuracy_tables.md;
#+                             with --publish [ROBOTS] it measures and writes them
#+ fuzz --constraints [SECONDS | --problems N]  the same of rbd_constraints.h against dense matrices in long
#+                             double; --publish [PROBLEMS]
#+ fuzz --contacts [SECONDS | --problems N]  the same of rbd_contact.h: laws, energy, a second method, runs of
#+                             robots, broken descriptions; prints tables; --publish [PROBLEMS]
#+ fuzz --qp [SECONDS | --problems N]  random quadratic programs, each answer judged by its own conditions
#+ fuzz --ik [SECONDS | --poses N]  inverse kinematics: 10,000 random poses of each of four arms, places out of reach
#+ fuzz --tasks | --actuators | --estimate [SECONDS | --problems N]  random robots for rbd_tasks.h, rbd_actuator.h or
#+                             rbd_estimate.h, each answer judged by laws and formulas of its own
#+ fuzz --codegen [models | ROBOTS [FIRST]]  generated code of the models and of 200 random robots against rbd.h, by
#+                             gcc and clang with sanitizers; or of one of the two
cmd_fuzz() {
    prepare
    case ${1-} in
    --codegen)
        shift
        install fuzz quad
        bring_up tools/rbd-codegen tests/codegen/codegen_fuzz
        with_clock "$root/tests/codegen/fuzz.sh" "$root" "$build/tools/rbd-codegen" "$build/tests/codegen/codegen_fuzz" \
            "$build/fuzz/codegen" "$@"
        return
        ;;
    --library | --constraints | --contacts | --qp | --ik | --tasks | --actuators | --estimate)
        fuzzer=${1#--}
        shift
        install quad
        with_clock env CC=gcc "$root/tests/fuzz/$fuzzer.sh" "$build/fuzz" "$@"
        return
        ;;
    esac
    install fuzz
    "$root/tests/urdf/fuzz/fuzz.sh" "$build/fuzz" "$@"
}

#+ prove [quick | all | two]   prove by Frama-C that indices and sizes are right: tests/proof/README.md
cmd_prove() {
    prepare
    install prove
    "$root/tests/proof/prove.sh" "$build/proof" "$@"
}

#+ coverage [OPTION...]        what the tests do not reach of the headers, by line
cmd_coverage() {
    prepare
    install build coverage
    takes "two minutes or so on two cores"
    with_clock "$root/tests/adequacy/coverage.py" "$build/coverage" "$@"
}

#: site                        the reference, the guides and the playground as pages: build/site/index.html, to open in
#:                             a browser
cmd_site() {
    prepare
    install site
    playground=no
    if [ -f "$root/web/playground/build.sh" ]; then
        install_optional web
        [ -n "$(missing web)" ] || playground=yes
        [ $playground = yes ] || say "run: the site is without its playground"
    fi
    [ $playground = no ] || takes "a minute or two the first time, for the playground; then half a minute"
    quietly env RBD_PLAYGROUND=$playground "$root/docs/site/build.sh" "$build/site"
    printf '%s\n' "$build/site/index.html"
}

#: wheel [PLATFORM...]         Python packages that bring the library compiled, into build/wheels: linux-x86-64 (the default),
#:                             linux-aarch64, windows-x86-64
cmd_wheel() {
    prepare
    install build packages
    [ $# -gt 0 ] || set -- linux-x86-64
    install wheels
    takes "five minutes of a processor for each platform"
    for platform; do
        /usr/bin/python3 "$root/python/make_wheel.py" "$platform" "$build/wheels" || exit
    done
}

#+ release [--draft]           all that a release consists of, in build/release: archives, wheels for three platforms, the site,
#+                             checksums, a bill of materials; --draft in spite of changes or a missing date
cmd_release() {
    "$root/packaging/release.py" --check "$@" || exit
    cmd_site # first: it takes less, and fails more often
    rm -rf "$build/wheels" # of headers as they were
    cmd_wheel linux-x86-64 linux-aarch64 windows-x86-64
    rm -rf "$build/release"
    "$root/packaging/release.py" --wheels "$build/wheels" --site "$build/site" "$@" "$build/release"
}

#+ budgets [--accept]          text and compile time of the headers beside their budgets, and how the rooms read;
#+                             --accept keeps the figures in bench/results/budgets.csv
cmd_budgets() {
    prepare
    install count
    takes "three minutes or so"
    with_clock "$root/tests/adequacy/budgets.py" "$@"
}

#+ rooms [OPTION]              whether src/ is in order, its includes and interfaces; --mend, --interfaces and --draw
#+                             write them, and docs/rooms.svg; then it makes what follows from rooms and declarations:
#+                             symbols, shipped headers, tests/plain_calls.h, rows of docs/interface.md
cmd_rooms() {
    "$root/tests/adequacy/rooms.py" "$@" || exit
    "$root/src/amalgamate.py" --write && python3 -B "$root/tests/interface.py" --write
}

#+ reproducible [REGEX]        whether RBD_REPRODUCIBLE and generated code give the same bits with all compilers, options and
#+                             machines; an hour and a half or so on two cores; REGEX: those whose command line it matches
cmd_reproducible() {
    prepare
    install build
    install_optional compilers machines firmware
    bring_up tools/rbd-codegen
    takes "an hour and a half or so on two cores"
    RBD_CODEGEN=$build/tools/rbd-codegen "$root/tests/reproducible.sh" --all "$root" "$@"
}

#+ wasm                        the tests as WebAssembly in node, with and without SIMD, the bits of RBD_REPRODUCIBLE, and
#+                             rbd-model and rbd-codegen beside the native ones
cmd_wasm() {
    prepare
    install build web
    takes "five minutes or so on two cores"
    bring_up tools/rbd-model tools/rbd-codegen
    RBD_ALL_TESTS=yes "$root/tests/machines.sh" "$root" wasm && "$root/tests/machines.sh" "$root" wasm-suites &&
        RBD_CODEGEN=$build/tools/rbd-codegen "$root/tests/reproducible.sh" --all "$root" wasm &&
        "$root/web/wasm/test.sh" "$build/tools" "$build/web"
}

#+ mutants [OPTION...]         faults put into the headers, one at a time: which no test sees; about an hour on two
#+                             cores; it goes on where it was stopped
cmd_mutants() {
    prepare
    install build test
    install_optional mutants
    case " $* " in *" --count "* | *" --refresh "*) ;; *) takes "an hour or so on two cores" ;; esac
    "$root/tests/adequacy/mutants.py" "$build/mutants" "$@"
}

#+ firmware [OPTION...]        build for microcontrollers, run under QEMU, measure
cmd_firmware() {
    prepare
    install build firmware
    bring_up tools/rbd-codegen
    "$root/bench/firmware/firmware.py" "$build/firmware" --codegen "$build/tools/rbd-codegen" "$@"
}

#: deps [GROUP...]             install, as root, what ./run test needs, or what these groups do: build, quick, test,
#:                             packages, compilers, clang, format, coverage, mutants, machines, firmware, fuzz, count,
#:                             report, peers, prove, site, web, browser
cmd_deps() {
    prepare
    # shellcheck disable=SC2086 # words wanted
    if [ $# -eq 0 ]; then
        install $test_groups
        install_optional $test_options
        return
    fi
    for group; do
        needs | grep -q "^\([^ ]*,\)\{0,1\}${group}[, ]" || die "no group $group: ./run deps --help"
    done
    install "$@"
}

#: help                        this list
cmd_help() {
    echo "usage: ./run COMMAND"
    printf '\nTo use rbd:\n\n'
    cat "$parts/test.sh" "$parts/quick.sh" "$parts/commands.sh" | sed -n 's/^#: /  /p'
    printf '\nTo work on rbd (CONTRIBUTING.md):\n\n'
    cat "$parts/test.sh" "$parts/quick.sh" "$parts/commands.sh" | sed -n 's/^#+ /  /p'
    printf '\n./run COMMAND --help: the options\n'
}
