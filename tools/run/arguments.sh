# Looks at what is asked for, before anything is built. Sourced by ../../run.
# shellcheck shell=sh disable=SC2154 # run sets root, parts and command

# Whether an argument asks for help.
asks_help() {
    case " $* " in *" --help "* | *" -h "*) ;; *) return 1 ;; esac
}

# The lines of ./run help for a command: "#: " in the files of the commands are for users, "#+ " for contributors.
help_of() {
    awk -v "name=$1" '/^#[:+] / { if (substr($0, 4, 1) != " ") on = $2 == name; if (on) print "  " substr($0, 4) }' \
        "$parts"/*.sh
}

# The help of what does the work, which needs no build; nothing where the lines of the list say all.
more_help() {
    case $1 in
    bench) sed -n '/^static const char help/,/;$/ s/^    "\(.*\)\\n".*/\1/p' "$root/bench/options.c" ;;
    instructions) "$root/bench/counters/instructions.sh" "$root" --help ;;
    report) python3 "$root/bench/workload/report.py" --help ;;
    coverage | mutants) "$root/tests/adequacy/$1.py" --help ;;
    firmware) "$root/bench/firmware/firmware.py" --help ;;
    test) ! have meson || meson test --help ;;
    esac
}

# refuse_unknown_options COMMAND ARGUMENT...: those that start with -- and are in no help of the command
refuse_unknown_options() {
    command=$1
    shift
    case $command in
    tools | site | wasm | help) [ $# -eq 0 ] || die "$command takes no argument" ;;
    reproducible) return ;; # a pattern
    test) return ;; # meson knows: refuse_unknown_tests
    esac
    texts=$(help_of "$command"; more_help "$command" 2>/dev/null)
    for argument; do
        case $argument in --[a-z]*) ;; *) continue ;; esac
        printf '%s\n' "$texts" | grep -q -e "${argument%%=*}\([^a-z-]\|\$\)" ||
            die "$command has no option '${argument%%=*}': ./run $command --help"
    done
}

# nearest NAME: the line of standard input that is most like it, if one is
nearest() {
    python3 -c 'import difflib, sys
near = difflib.get_close_matches(sys.argv[1], sys.stdin.read().splitlines(), 1, 0.5)
print("; did you mean \x27%s\x27?" % near[0] if near else "")' "$1"
}
