#!/usr/bin/env python3
"""measures.py refuses each way to lose NaN, and nothing else."""
import sys
import tempfile
from pathlib import Path

import measures

# A line, and a word of the sentence that refuses it, or None.
LINES = [
    ("worst = fmax(worst, fabs(x - y));", "fmax passes"),
    ("worst = fmaxl(fabsl(x), worst);", "fmaxl passes"),
    ("    t->worst = std::fmax(t->worst, x);", "fmax passes"),
    ("worst = std::max(worst, x);", "max passes"),
    ("error = isfinite(x) ? fmax(error, x) : HUGE_VAL;", "fmax passes"),
    ("wound = fmax(0, fabs(x) - y);", "fmax passes"),
    ("*worst = fmax(*worst, x);", "fmax passes"),
    ("size[k] = fmax(size[k], fabs(x));", "fmax passes"),
    ("if (!(x <= worst)) worst = x;", "next number"),
    ("if (!(error / size <= worst)) worst = error / size;", "next number"),
    ("if (error > worst) worst = error;", "not greater"),
    ("worst = error > worst ? error : worst;", "chosen"),
    ("error = x <= error ? error : x;", "chosen"),
    ("bound = larger(bound, 1e-12);", "infinite"),
    ("worst = larger(worst, fabs(x - y));", None),
    ("bound = fmax(bound, 1e-15 * condition);", None),
    ("const double bound = fmax(1e-12, 1e-15 * condition);", None),
    ("x = fmin(fmax(x, -1), 1);", None),
    ("if (!(x <= bound)) failures++;", None),
    ("int most = 0; if (steps > most) most = steps;", None),
    ("uint32_t sum[2] = {0, 0}, most = 0; if (steps > most) most = steps;", None),
    ("long double far = 0, most = 0; if (x > most) most = x;", "not greater"),
    ("worst = fmax(worst, x); const int good = y > 0 && worst < 1;", "fmax passes"),
    ("/* worst = fmax(worst, x); */", None),
]


def main():
    failures = 0
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "test.c"
        for text, word in LINES:
            path.write_text(f"double worst, error;\n{text}\n", encoding="utf-8")
            found = list(measures.findings(path))
            if word is None and found or word is not None and (len(found) != 1 or word not in found[0][1] or found[0][0] != 2):
                print(f"{text}\n    expected: {word}, found: {found}")
                failures += 1
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
