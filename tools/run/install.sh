# Installs what packages.txt lists, as root, by Debian's apt-get. Sourced by ../../run.
# shellcheck shell=sh disable=SC2154 # run sets parts and log

needs() { grep -v '^#' "$parts/packages.txt"; }

compiles() { printf '#include <stdio.h>\n' | cc -E -; }
profile_runtime() { ls "$(clang-19 -print-resource-dir)"/lib/*/libclang_rt.profile*.a; }
fuzzer_runtime() { ls "$(clang++-19 -print-resource-dir)"/lib/*/libclang_rt.fuzzer*.a; }

wasm_libraries() {
    [ -e /usr/lib/wasm32-wasi/libc.a ] && echo '#include <vector>' | clang++-19 --target=wasm32-wasi -x c++ -fsyntax-only -
}

is_there() {
    case $1 in
    command:*) have "${1#*:}" ;;
    file:*) [ -e "${1#*:}" ] ;;
    module:*) pkg-config --exists "${1#*:}" ;;
    python:*) python3 -c "import ${1#*:}" || /usr/bin/python3 -c "import ${1#*:}" ;;
    *) "$1" ;;
    esac >/dev/null 2>&1 </dev/null
}

# missing GROUP...: the packages of these groups that are not there, each once
missing() {
    needs | while read -r groups check packages; do
        for group; do
            case ,$groups, in *",$group,"*) is_there "$check" || printf '%s\n' "$packages"; break ;; esac
        done
    done | tr ' ' '\n' | awk '!seen[$0]++'
}

# Sets $as_root to what makes a command run as root; fails if nothing does.
find_root() {
    have apt-get || return 1
    as_root=
    [ "$(id -u)" -eq 0 ] && return
    as_root=sudo
    have sudo && { sudo -n true 2>/dev/null || [ -t 0 ]; }
}

apt() { $as_root env DEBIAN_FRONTEND=noninteractive LC_ALL=C apt-get -qq -o DPkg::Lock::Timeout=600 "$@"; }

# Reads the package lists. Apt does not wait for their lock, so this does.
apt_update() {
    for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
        apt update >"$log" 2>&1 && return
        grep -q 'lock' "$log" || return
        sleep "${RUN_LOCK_WAIT:-30}"
    done
    return 1
}

# Whether the package lists have this package.
apt_knows() { [ -n "$(apt-cache madison "$1" 2>/dev/null)" ]; }

# The size of these packages as apt prints it, in one line; fails if apt does not know one of them.
apt_size() {
    LC_ALL=C apt-get -q -o Debug::NoLocking=1 --assume-no --no-install-recommends install "$@" 2>&1 |
        awk '/^Need to get/ { sub(/^Need to get /, ""); sub(/ of archives\.$/, ""); fetch = $0 }
             /^After this operation/ { disk = $4 " " $5 }
             END { if (disk == "") exit 1; print fetch " to fetch, " disk " on disk" }'
}

# Installs packages; reads the package lists anew only if it does not work without.
apt_install() {
    size=$(apt_size "$@") || { apt_update; size=$(apt_size "$@"); }
    say "run: installing $*"
    say "run: ${size:-size unknown}; if another apt is at work, this waits up to ten minutes for it"
    apt install -y --no-install-recommends "$@" >"$log" 2>&1 ||
        { apt_update && apt install -y --no-install-recommends "$@" >"$log" 2>&1; }
}

# install GROUP...: what is missing of these groups
install() {
    # shellcheck disable=SC2046 # words wanted
    set -- $(missing "$@")
    [ $# -eq 0 ] && return
    have apt-get || die "please install (these are Debian's names): $*"
    find_root || die "please install, as root: apt-get install $*"
    apt_install "$@" || { cat "$log" >&2; die "could not install: $*"; }
}

# install_optional GROUP...: the same as far as it can be had
install_optional() {
    groups=$*
    # shellcheck disable=SC2046 # words wanted
    set -- $(missing "$@")
    if [ $# -gt 0 ] && find_root; then
        apt_knows dash || apt_update # a fresh image has no package lists
        for package; do
            shift
            ! apt_knows "$package" || set -- "$@" "$package"
        done
        [ $# -eq 0 ] || apt_install "$@" || for package; do apt_install "$package"; done
    fi
    # shellcheck disable=SC2046,SC2086 # words wanted
    set -- $(missing $groups)
    [ $# -eq 0 ] || say "run: doing without $*"
}
