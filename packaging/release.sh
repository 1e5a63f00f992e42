#!/bin/sh
# What release.py writes: archives that suffice to compile, the same bytes twice, checksums that hold; and what it refuses.
# usage: release.sh DIRECTORY_OF_RBD_H
set -eu

root=${1:?usage: release.sh DIRECTORY_OF_RBD_H}
git -C "$root" rev-parse --git-dir >/dev/null 2>&1 || { echo "needs a git repository"; exit 77; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
version=$(sed -n 's/^#define RBD_VERSION "\(.*\)"/\1/p' "$root/rbd.h")
fail() { echo "FAILED: $*"; exit 1; }

# A copy with a date, committed: then nothing is refused.
git clone -q "$root" "$scratch/tree"
cd "$scratch/tree"
git config user.name test
git config user.email test@localhost
release() { python3 -B packaging/release.py "$@" 2>"$scratch/messages"; }

sed "s/^## $version - .*/## $version - soon/" CHANGELOG.md >"$scratch/changelog"
cp "$scratch/changelog" CHANGELOG.md
! release "$scratch/refused" || fail "a version without a date is released"
[ ! -e "$scratch/refused" ] || fail "something is written in spite of an error"
grep -q "the date of $version is 'soon'" "$scratch/messages" || fail "the date is not named"
grep -q "not committed" "$scratch/messages" || fail "changes are not named"

sed "s/^## $version - .*/## $version - 2030-02-30/" "$scratch/changelog" >CHANGELOG.md
! release "$scratch/refused" || fail "30 February is a date"
grep -q "the date of $version is '2030-02-30'" "$scratch/messages" || fail "a day that is none is not named"

# A draft has what lies there, in all of its archives, and leaves the repository as it was.
echo "// changed" >>rbd.h
echo new >models/new.h
git status --porcelain >"$scratch/before"
release --draft "$scratch/draft" >/dev/null || fail "$(cat "$scratch/messages")"
git status --porcelain | cmp - "$scratch/before" || fail "a draft changes the index"
mkdir "$scratch/unpacked"
tar -xzf "$scratch/draft/rbd-$version.tar.gz" -C "$scratch/unpacked"
cmp rbd.h "$scratch/unpacked/rbd-$version/rbd.h" || fail "the source of a draft is another than its tree"
mv "$scratch/unpacked/rbd-$version" "$scratch/unpacked/source"
python3 -m zipfile -e "$scratch/draft/rbd-$version-headers.zip" "$scratch/unpacked"
for name in rbd.h models/new.h CHANGELOG.md; do
    cmp "$name" "$scratch/unpacked/rbd-$version/$name" && cmp "$name" "$scratch/unpacked/source/$name" || fail "a draft has another $name"
done
rm models/new.h
git checkout -q rbd.h

sed "s/^## $version - .*/## $version - 2030-01-31/" "$scratch/changelog" >CHANGELOG.md
git commit -qam "A date"
! release --wheels "$scratch" "$scratch/refused" || fail "a folder without wheels is taken"
grep -q "has no wheel of $version" "$scratch/messages" || fail "missing wheels are not named"

mkdir "$scratch/wheels"
python3 - "$scratch/wheels/rbd-$version-py3-none-any.whl" <<'PYTHON'
import pathlib, sys, zipfile
with zipfile.ZipFile(sys.argv[1], "w") as wheel:
    for path in pathlib.Path().glob("rbd*.h"):
        wheel.writestr(f"rbd/sources/{path.name}", path.read_text() + "\n")
PYTHON
! release --wheels "$scratch/wheels" "$scratch/old" || fail "a wheel of other headers is taken"
grep -q "has other headers" "$scratch/messages" || fail "a wheel of other headers is not named"

mkdir -p "$scratch/site/licences" "$scratch/site/playground"
touch "$scratch/site/index.html" "$scratch/site/licences/furo.txt"
printf '==== rbd\n\n==== three 0.1.2, MIT\n\n==== urdfdom (in the WebAssembly modules)\n' >"$scratch/site/playground/LICENCES.txt"
release --site "$scratch/site" "$scratch/with_site" >/dev/null || fail "$(cat "$scratch/messages")"
python3 - "$scratch/with_site/rbd-$version.spdx.json" <<'PYTHON' || fail "the bill of materials is another"
import json, sys
bill = json.load(open(sys.argv[1]))
packages = {p["SPDXID"]: p for p in bill["packages"]}
inside = [packages[r["relatedSpdxElement"]] for r in bill["relationships"] if r["relationshipType"] == "CONTAINS"]
assert [(p["name"], p["licenseDeclared"]) for p in inside] == [("furo", "NOASSERTION"), ("three", "MIT"), ("urdfdom", "NOASSERTION")]
assert [p["licenseConcluded"] for p in packages.values()].count("MIT") == 4  # three other files, and three
PYTHON

release "$scratch/out" >/dev/null || fail "$(cat "$scratch/messages")"
release "$scratch/again" >/dev/null
! release "$scratch/out" >/dev/null || fail "what lay in the folder is released"
grep -q "is not empty" "$scratch/messages" || fail "a folder that is not empty is not named"
(cd "$scratch/out" && sha256sum -c --quiet SHA256SUMS)
cmp "$scratch/out/SHA256SUMS" "$scratch/again/SHA256SUMS" || fail "the same commit gives other bytes"
python3 -c 'import json, sys; assert json.load(open(sys.argv[1]))["spdxVersion"] == "SPDX-2.3"' "$scratch/out/rbd-$version.spdx.json"

# What is in the archives compiles alone.
for kind in headers arduino; do
    python3 -m zipfile -e "$scratch/out/rbd-$version-$kind.zip" "$scratch/$kind"
done
grep -v batch src/headers.txt | sed '1i #define RBD_IMPLEMENTATION
s/.*/#include "&"/' >"$scratch/unit.c"
for folder in "$scratch/headers/rbd-$version" "$scratch/arduino/rbd-$version/src"; do
    "${CC:-cc}" -std=c99 -fsyntax-only -I"$folder" "$scratch/unit.c"
done
[ -f "$scratch/headers/rbd-$version/models/hyq_model.h" ] || fail "no models"
[ -f "$scratch/arduino/rbd-$version/library.properties" ] || fail "no library.properties"
tar -xzf "$scratch/out/rbd-$version.tar.gz" -C "$scratch"
[ -x "$scratch/rbd-$version/run" ] || fail "the source is not complete"
echo "release $version: ok"
