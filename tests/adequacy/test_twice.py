#!/usr/bin/env python3
"""twice.py refuses a function that stands in two rooms, and no other."""
import sys
import tempfile
from pathlib import Path

import twice

SUM = """/* The sum of squares. */
RBDI_PART rbd_real rbdi_sum_of_squares(const rbd_real *x, int n) {
    rbd_real sum = rbdi_zero();
    for (int i = 0; i < n; ++i) sum = sum + x[i] * x[i];
    return sum;
}
"""
# Another room, and whether it has the function of the first.
OTHERS = [
    (SUM, 1),
    ("RBDI_LOCAL rbd_real rbdi_est_length(rbd_real *a, int count) {\n    rbd_real all = rbdi_zero(); /* so far */\n\n"
     "    for (int k = 0; k < count; ++k) all = all + a[k] * a[k];\n    return all;\n}\n", 1),
    (SUM.replace("x[i] * x[i]", "x[i]"), 0),
    (SUM.replace("rbdi_zero", "rbdi_one"), 0),
    (SUM.replace("rbd_real *x", "double *x"), 0),
    ("RBDI_INLINE int rbdi_rows(const rbd_set *s) { return s->rows; }\n", 0),
]


def main():
    failures = 0
    with tempfile.TemporaryDirectory() as folder:
        one, two = Path(folder) / "one.h", Path(folder) / "two.h"
        one.write_text("RBDI_INLINE int rbdi_count(const rbd_set *x) { return x->rows; }\n" + SUM, encoding="utf-8")
        for text, expected in OTHERS:
            two.write_text(text, encoding="utf-8")
            found = list(twice.findings([one, two]))
            if len(found) != expected or expected and ("one.h:3" not in found[0] or "rbdi_sum_of_squares" not in found[0]):
                print(f"{text}\n    found: {found}")
                failures += 1
        if list(twice.findings([one])):
            print("a room is refused for itself")
            failures += 1
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
