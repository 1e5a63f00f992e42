#!/bin/sh
# Builds the site: build.sh FOLDER [OPTION OF SPHINX...]. RBD_PLAYGROUND=yes: with the playground. With --check in place of FOLDER
# Sphinx reads the pages and follows their references, and nothing is written.
set -eu
here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd) root=$(CDPATH='' cd -- "$(dirname -- "$0")/../.." && pwd)
out=${1:?usage: build.sh FOLDER}
shift
builder=html
[ "$out" != --check ] || builder=dummy
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
if [ "${RBD_PLAYGROUND-no}" = yes ]; then # first: the pages link it
    status=0
    RBD_HOME=../index.html sh "$root/web/playground/build.sh" "$scratch/playground" || status=$?
    case $status in
    0) ;;
    77) export RBD_PLAYGROUND=no; echo "the site is without its playground" >&2 ;;
    *) exit 1 ;;
    esac
fi
python3() { if [ -x /usr/bin/python3 ]; then /usr/bin/python3 "$@"; else command python3 "$@"; fi; } # Debian's Sphinx
python3 "$here/pages.py" "$scratch/pages"
cp -R "$here/static" "$scratch/pages/static"
cp -RL /usr/share/javascript/katex "$scratch/pages/static/katex"
mkdir -p "$scratch/pages/extra/licences"
for package in libjs-katex fonts-katex furo node-normalize.css sphinx-common; do
    [ ! -f "/usr/share/doc/$package/copyright" ] || cp "/usr/share/doc/$package/copyright" "$scratch/pages/extra/licences/$package.txt"
done
# Without the collector of cycles, which takes a third of the time and finds little.
RBD_ROOT=$root python3 -c 'import gc, runpy; gc.disable(); runpy.run_module("sphinx", run_name="__main__")' -q -b $builder -d "$scratch/trees" "$@" "$scratch/pages" "$scratch/site"
[ $builder = html ] || exit 0
python3 "$here/theme.py" "$scratch/site"
python3 "$here/search_index.py" "$scratch/site" >/dev/null
rm -f "$scratch/site/objects.inv" "$scratch/site/.buildinfo"
[ "${RBD_PLAYGROUND-no}" = no ] || mv "$scratch/playground" "$scratch/site/playground"
mkdir -p "$(dirname -- "$out")"
rm -rf "$out"
mv "$scratch/site" "$out"
