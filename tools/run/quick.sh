# ./run quick: the loop of somebody who edits a room. Sourced by ../../run. "#: " and "#+ " lines are the help.
# shellcheck shell=sh disable=SC2154 # run sets root and parts

# Files of C and C++ that differ from the last commit, and new ones, but the shipped headers, which are made.
changed_sources() {
    (cd "$root" && git diff --name-only --diff-filter=d HEAD && git ls-files --others --exclude-standard) 2>/dev/null |
        grep '\.[ch]$\|\.[ch]pp$\|\.ino$' |
        grep -v -x -F -f "$root/src/headers.txt"
}

format_changed() {
    have clang-format-19 || { say "run: clang-format-19 is not installed: nothing is formatted"; return; }
    # shellcheck disable=SC2046 # no name of ours has a blank
    set -- $(changed_sources)
    [ $# -eq 0 ] || (cd "$root" && clang-format-19 -i "$@")
}

# A build folder of its own, not optimised but with the code for optimising compilers. A room compiles in a second by
# clang 19, where it is, and in three by GCC. The suites take a tenth of their random trees.
configure_quick() {
    cc=${CC-}
    [ -n "$cc" ] || ! have clang-19 || cc=clang-19
    set -- -Doptimization=0 '-Dc_args=-Dalways_inline=unused -D__OPTIMIZE__=1 -DPART_OF_TREES=10' \
        -Dtests=enabled -Dbench=disabled -Durdf=disabled
    now="$root $cc $*"
    [ "$(cat "$stamp")" != "$now" ] || [ ! -e "$build/build.ninja" ] || return 0
    rm -rf "$build"
    prepare
    say "run: configuring ${build##*/}/"
    quietly env ${cc:+"CC=$cc"} meson setup "$build" "$root" "$@"
    printf '%s\n' "$now" >"$stamp"
}

# run_programs: each line of standard input is a program of the build folder and its arguments. Tests with the tag
# $left_out are.
run_programs() {
    failed=0
    while read -r program arguments; do
        # shellcheck disable=SC2086 # words wanted
        CK_TIMEOUT_MULTIPLIER=100 CK_EXCLUDE_TAGS=$left_out "$build/$program" $arguments </dev/null || failed=1
    done
    return $failed
}

#+ quick [SUITE...]            after an edit: formats what changed, makes the headers, builds in build-quick/ without
#+                             optimisation and runs these suites, or those of what changed since the last commit
#+                             (every one if nothing did), without their slow tests; all: every suite, with them
#+ quick --map                 the suites of each room
cmd_quick() {
    [ "${1-}" != --map ] || { "$parts/suites.py" --map; return; }
    programs=$("$parts/suites.py" "$@") || exit
    use_folder build-quick
    prepare
    install quick
    take_lock
    format_changed
    "$root/src/amalgamate.py" --write
    configure_quick
    # shellcheck disable=SC2046 # words wanted
    compile $(printf '%s\n' "$programs" | sed 's/ .*//')
    left_out=slow
    [ "${1-}" != all ] || left_out=
    printf '%s\n' "$programs" | run_programs
}
