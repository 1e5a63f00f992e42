#!/bin/sh
# CONTENTS of each header names its sections, each once and in their order, and every section has a tag.
# usage: sections.sh DIRECTORY_OF_RBD_H
set -u

root=${1:?usage: sections.sh DIRECTORY_OF_RBD_H}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# The tags between the line CONTENTS and the next empty one.
contents() {
    awk '/^   CONTENTS/ { inside = 1; next }
         inside && NF == 0 { exit }
         inside { while (match($0, /\[[^]]*\]/)) {
             print substr($0, RSTART, RLENGTH)
             $0 = substr($0, RSTART + RLENGTH)
         } }' "$1"
}

# The tags of the sections: in the first comment a line begins with it, below it a headline ends with it.
sections() {
    awk '!below && match($0, /^   \[[^]]*\]/) { print substr($0, 4, RLENGTH - 3) }
         /\*\/$/ { below = 1 }
         /^\/\* ---- / {
             if (match($0, /\[[^]]*\] ----/)) print substr($0, RSTART, RLENGTH - 5)
             else print "line " NR " without a tag: " $0
         }' "$1"
}

status=0
for header in "$root"/rbd*.h; do
    contents "$header" >"$scratch/contents"
    sections "$header" >"$scratch/sections"
    [ "$(wc -l <"$scratch/contents")" -ge 5 ] || { echo "$header: CONTENTS not found"; status=1; }
    diff "$scratch/contents" "$scratch/sections" >"$scratch/differences" && continue
    echo "$header: < only in CONTENTS, > only in the text:"
    grep '^[<>]' "$scratch/differences"
    status=1
done
exit $status
