#!/bin/sh
# A user's project finds rbd as a Meson subproject, and where `meson install` put it.
# usage: meson.sh DIRECTORY_OF_RBD_H
set -eu
CFLAGS="${CFLAGS-} -Dalways_inline=unused" # it compiles in a third of the time without forced inlining
export CFLAGS

root=${1:?usage: meson.sh DIRECTORY_OF_RBD_H}
consumer=$root/packaging/consumer
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

echo "subproject:"
mkdir -p "$scratch/project/subprojects"
cp "$consumer/main.c" "$consumer/meson.build" "$scratch/project"
ln -s "$root" "$scratch/project/subprojects/rbd"
meson setup "$scratch/build" "$scratch/project" >"$scratch/log" || { cat "$scratch/log"; exit 1; }
meson test -C "$scratch/build" --verbose >"$scratch/log" || { cat "$scratch/log"; exit 1; }
grep '^rbd ' "$scratch/log"
built=$(ninja -C "$scratch/build" -t targets all | grep -c '_COMPILER$')
[ "$built" -eq 1 ] || { echo "the subproject compiles files of its own"; exit 1; }

echo "meson install, pkg-config:"
meson setup "$scratch/install" "$root" --prefix=/opt/rbd -Dauto_features=disabled >"$scratch/log" ||
    { cat "$scratch/log"; exit 1; }
DESTDIR=$scratch/image meson install -C "$scratch/install" >"$scratch/log" || { cat "$scratch/log"; exit 1; }
PKG_CONFIG_PATH=$(dirname "$(find "$scratch/image" -name rbd.pc)")
PKG_CONFIG_SYSROOT_DIR=$scratch/image
export PKG_CONFIG_PATH PKG_CONFIG_SYSROOT_DIR
version=$(sed -n 's/^#define RBD_VERSION "\(.*\)"/\1/p' "$root/rbd.h")
pkg-config --exact-version="$version" rbd || { echo "rbd.pc is not version $version"; exit 1; }
# shellcheck disable=SC2046,SC2086 # words wanted
${CC:-cc} -std=c99 $CFLAGS $(pkg-config --cflags rbd) "$consumer/main.c" -o "$scratch/consumer" $(pkg-config --libs rbd)
"$scratch/consumer"
