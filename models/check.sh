#!/bin/sh
# check.sh WRITE_MODEL DIR: fails if a built model in DIR is not what the program writes today.
# With a third argument it writes them instead.
status=0
for file in "$2"/*_model.h; do
    name=$(basename "$file" _model.h)
    if [ $# -gt 2 ]; then
        "$1" "$name" >"$file"
    elif "$1" "$name" | cmp -s - "$file"; then
        echo "$name: up to date"
    else
        echo "$name: out of date; write it again with models/check.sh $1 models write"
        status=1
    fi
done
exit $status
