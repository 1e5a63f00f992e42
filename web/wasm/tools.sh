#!/bin/sh
# Builds rbd-model.wasm, rbd-codegen.wasm and rbd-eval.wasm from the unchanged sources of tools/ and of urdfdom, with
# Debian's clang for wasm32-wasi (`./run deps web`); tools.mk has the rules. Fetches the sources of urdfdom from Debian,
# once, in the versions below.
# usage: tools.sh FOLDER [OPTIMIZATION]   writes FOLDER/*.wasm, keeps objects in FOLDER/build; OPTIMIZATION: -Oz
set -eu

usage='usage: tools.sh FOLDER [OPTIMIZATION]'
wasm=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
mkdir -p "${1:?$usage}/build"
out=$(CDPATH='' cd -- "$1" && pwd)
build=$out/build
exec 9>"$build/.lock" # until make ends: others may build in the same folder
flock 9

release=bookworm # of Debian
sources='urdfdom=3.0.1-1 urdfdom-headers=1.0.5-3 tinyxml=2.6.2-6+deb12u1 console-bridge=1.0.1+dfsg2-3'

# apt with lists and files of its own: nothing of the system's changes, and nobody needs to be root.
own_apt() {
    apt-get -qq -o Dir::Etc::SourceList="$fetched/sources.list" -o Dir::Etc::SourceParts=- \
        -o Dir::State::Lists="$fetched/lists" -o Dir::Cache="$fetched/cache" -o APT::Sandbox::User= "$@"
}

fetch() {
    mkdir -p "$fetched/lists/partial" "$fetched/cache/archives/partial"
    echo "deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg]" \
        "${DEBIAN_MIRROR-http://deb.debian.org/debian} $release main" >"$fetched/sources.list"
    # shellcheck disable=SC2086 # words wanted
    own_apt update && (cd "$fetched" && own_apt source $sources)
}

# urdfdom and what it needs, unpacked in folders without versions in their names.
if [ ! -d "$build/urdfdom" ]; then
    fetched=$build/fetched
    rm -rf "$fetched"
    mkdir "$fetched"
    fetch >"$build/log.txt" 2>&1 || { cat "$build/log.txt" >&2; echo "skipped: no sources of urdfdom" >&2; exit 77; }
    mkdir "$fetched/urdfdom"
    for source in $sources; do
        mv "$fetched/${source%%=*}"-[0-9]*/ "$fetched/urdfdom/${source%%=*}"
    done
    mv "$fetched/urdfdom" "$build"
    rm -rf "$fetched"
fi

exec make --quiet -j "$(nproc)" -f "$wasm/tools.mk" ROOT="$(dirname "$(dirname "$wasm")")" OUT="$out" \
    OPTIMIZATION="${2--Oz}"
