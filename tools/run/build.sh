# Configures a build folder and builds in it, one command at a time. Sourced by ../../run.
# shellcheck shell=sh disable=SC2154 # run sets root, command and locked

# use_folder NAME: the build folder, of a name that begins with build
use_folder() {
    build=$root/$1
    stamp=$build/.run # ./run made the folder; once configured, the path of the tree it was for
    log=$build/log.txt
    lock=$build/.lock # a folder while a command builds and uses what it built; holder: its process and name
}
use_folder build
# Of a new build/: for measuring. ./run test verifies alone, and without the peers.
bench_optimization=3 bench_peers=auto report_tests=false

# Groups that meson.build looks for: if one comes or goes, build/ is configured anew.
meson_groups='build test packages compilers peers'

# Makes sure of build/: a new one, if there is none or only one of our own.
prepare() {
    [ ! -e "$stamp" ] || return 0
    [ ! -e "$build" ] || die "$build is not mine: move it away"
    mkdir "$build" && : >"$stamp" || exit 1
}

# Shows the log from the first failure on, and of a long one the beginning.
show_log() {
    awk '/^FAILED: / && !shown { shown = 1; for (i in early) delete early[i]; n = 0 }
         { early[++n] = $0 }
         END { for (i = 1; i <= n && i <= 60; i++) print early[i]
               if (n > 60) print "and so on: " name }' name="${log#"$root"/}" "$log" >&2
}

# Runs a command and shows what it printed only if it fails.
quietly() { "$@" >"$log" 2>&1 || { show_log; die "failed: $*"; }; }

# Keeps ninja's lines in the log and shows how far it is: on a terminal a line that the next one replaces, else
# a line for each tenth.
progress() {
    tenth=0
    while IFS= read -r line; do
        printf '%s\n' "$line"
        case $line in "["[0-9]*/[1-9]*"] "*) ;; *) continue ;; esac
        built=${line#?} && built=${built%%/*}
        all=${line#*/} && all=${all%%]*}
        if [ -t 2 ]; then
            printf '\r\033[K%.79s' "run: $line" >&2
        elif [ $((10 * built / all)) -gt "$tenth" ]; then
            tenth=$((10 * built / all))
            say "run: built $built of $all"
        fi
    done >"$log"
    [ ! -t 2 ] || printf '\r\033[K' >&2
}

# Runs ninja, with progress.
compile() {
    { ninja -C "$build" "$@" 2>&1 || echo failed >"$build/.failed"; } | progress
    [ ! -e "$build/.failed" ] || { rm -f "$build/.failed"; show_log; die "failed: ninja $*"; }
}

# Whether Pinocchio is there, which g++ makes 1.35 to 1.8 times slower than clang does.
have_pinocchio() { pkg-config --exists pinocchio 2>/dev/null; }

# The compiler of C++, if it is not the usual: clang beside Pinocchio.
cxx() {
    if [ -n "${CXX-}" ]; then
        echo "$CXX"
    elif have_pinocchio; then
        for name in clang++-19 clang++-16 clang++; do
            ! have $name || { echo $name; return; }
        done
    fi
}

# The things that build/ is configured for: this tree, the compiler of C++, the installed packages.
configuration() {
    # shellcheck disable=SC2086 # words wanted
    printf '%s\nC++: %s\nwithout: %s\n' "$root" "$(cxx)" "$(missing $meson_groups | tr '\n' ' ')"
}

# A new configuration. The folders report, firmware, fuzz, mutants, site and web in build/ stay, and how long commands
# took; all else goes.
configure_afresh() {
    : >"$stamp"
    find "$build" -mindepth 1 -maxdepth 1 ! -name "${stamp##*/}" ! -name "${lock##*/}" ! -name '.took-*' ! -name report \
        ! -name firmware ! -name fuzz ! -name mutants ! -name site ! -name web -exec rm -rf {} + || exit 1
    rm -rf "$build"/report/build-*
    say "run: configuring build/"
    cxx=$(cxx)
    quietly env ${cxx:+"CXX=$cxx"} meson setup "$build" "$root" --buildtype=release -Dtests=enabled -Dbench=enabled \
        -Durdf=enabled -Dbench_optimization="$bench_optimization" -Dpeers="$bench_peers" \
        -Dreport_tests="$report_tests"
}

# The same build/ once more, where something has been installed or removed since: what is built there stays.
configure_again() {
    say "run: configuring build/ again, since something has been installed or removed"
    meson configure "$build" --clearcache >"$log" 2>&1 && meson setup --reconfigure "$build" "$root" >"$log" 2>&1
}

# Configures build/ if it is missing, half done, a copy of another tree's, or something has been installed since.
configure() {
    now=$(configuration)
    before=$(cat "$stamp" 2>/dev/null)
    [ "$before" = "$now" ] && return
    if [ ! -e "$build/build.ninja" ] || [ "${before%%without:*}" != "${now%%without:*}" ] || ! configure_again; then
        configure_afresh
    fi
    printf '%s\n' "$now" >"$stamp"
}

# The bench for measuring, where ./run test has configured it for verifying alone.
bench_for_measuring() {
    ! grep -q '^bench_optimization = g' "$build/meson-private/cmd_line.txt" ||
        quietly meson configure "$build" -Dbench_optimization=3 -Dpeers=auto
}

# Waits until no other command works in build/; the lock of one that is no more does not count.
take_lock() {
    waiting=
    until mkdir "$lock" 2>/dev/null; do
        holder=$(cat "$lock/holder" 2>/dev/null)
        if [ -n "$holder" ] && ! kill -0 "${holder%% *}" 2>/dev/null; then
            rm -rf "$lock"
        elif [ -z "$waiting" ]; then
            waiting=yes
            say "run: waiting: ./run ${holder#* } (process ${holder%% *}) works in ${build##*/}/; if not, remove ${lock#"$root"/}"
        else
            sleep "${RUN_LOCK_WAIT:-2}"
        fi
    done
    locked=yes
    echo "$$ $command" >"$lock/holder"
}

# bring_up TARGET...: brings build/ and the targets up to date, and keeps other commands out of it until this one ends.
bring_up() {
    [ -n "$locked" ] || take_lock
    configure
    case $1 in bench/rbd-bench | bench/contact) bench_for_measuring ;; esac
    compile "$@"
}
