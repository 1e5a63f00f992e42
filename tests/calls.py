#!/usr/bin/env python3
"""The plain calls of rbd.h and rbd_derivatives.h: those whose declaration says all that a test must know to make them.
tests/plain_calls.h lists them for the tests, made of the declarations by interface.py --write.

A call is plain if it returns a status and takes a model, a work, memory of derivatives, arrays of known shape to read or to
write, a body, axes, and single numbers. SPDX-License-Identifier: MIT"""
import re
import sys
import textwrap
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "docs/site"))
import extract  # noqa: E402
import pages  # noqa: E402

HEADERS = ["rbd.h", "rbd_derivatives.h"]
OBJECTS = {"const rbd_model *": "MODEL", "rbd_work *": "WORK", "const rbd_work *": "WORK", "rbd_derivatives *": "DERIVATIVES",
           "rbd_axes": "AXES", "rbd_real": "NUMBER"}
# Arrays that a call reads and that must fit together: a test makes these calls by hand.
OF_ITS_OWN = ["mass_matrix", "packed", "factor", "rates"]
BOTH_WAYS = ["rbd_hybrid", "rbd_id_free_base", "rbd_cholesky_factor_packed"]  # read a and tau, or packed, and write them
MAY_FAIL = ["RBD_ERR_SINGULAR", "RBD_ERR_INFEASIBLE"]  # as the state or the model is; all else is an error here
TEXT = '''/* plain_calls.h - made by tests/interface.py --write from the declarations: do not edit.

   CALL(header, name, may_fail, arguments, n) for each plain call (tests/calls.py), with n results in all. A
   test defines what stands for the arguments: MODEL, WORK, DERIVATIVES, BODY, OTHER_BODY, AXES, NUMBER and

   Q(k)        the k-th configuration
   IN(k, n)    n numbers to read, the k-th such array of the call
   WEIGHTS(n)  n numbers to read, not negative
   OUT(at, n)  where n results go, of which `at` results stand before

   and the sizes NQ, NV, NB and NH, that of a packed matrix. BODY_CALLS are those of a body. */
#ifndef TESTS_PLAIN_CALLS_H
#define TESTS_PLAIN_CALLS_H
'''


def count(shape):
    """The number of entries of a shape, in C; None if it is not known."""
    if shape == "-":
        return "1"
    factors = []
    for word in shape.replace("rbd_packed_size(m)", "nh").split():
        part = re.fullmatch(r"(\d*)(n[qvbh])?", word)
        if not part:
            return None
        factors += [x for x in part.groups() if x]
    return " * ".join(factors).upper() or None


def input_array(name, size, k):
    if name in OF_ITS_OWN:
        return None
    if size == "NQ":
        return None if not name.startswith("q") else f"Q({int(name == 'q1')})"
    return f"IN({k}, {size})"


def arguments(item, own):
    """The arguments of a call in the words of plain_calls.h and the sizes of its results; None if it is not plain."""
    words, results, inputs = [], [], 0
    for kind, name, length in pages.parameters(item):
        kind = kind.strip()
        known, _ = pages.argument(item.name, name, own.get(name))
        size = count(known[0]) if known else None
        if size and size.isidentifier() and re.fullmatch(r"\[\d+\]", length):  # another call's `p` is as long as v
            size = length[1:-1]
        word = OBJECTS.get(kind)
        if kind == "int":
            word = {"body": "BODY", "reference": "OTHER_BODY"}.get(name)
        elif kind == "const rbd_const *" and name == "weight" and size:
            word = f"WEIGHTS({size})"
        elif kind == "const rbd_real *" and size:
            word = input_array(name, size, inputs)
            inputs += word is not None and word.startswith("IN(")
        elif kind == "rbd_real *" and size:
            word = f"OUT({' + '.join(results) or 0}, {size})"
            results.append(size)
        if not word:
            return None
        words.append(word)
    return words, results


def rows():
    """(header, name, whether it may fail, arguments, number of results) of each plain call, in order."""
    for header in pages.headers():
        if header.name not in HEADERS:
            continue
        for section in header.sections:
            for group in extract.groups(section):
                own = pages.own_words("\n".join(item.comment for item in group))
                for item in group:
                    if item.kind != "function" or not pages.signature(item).startswith("rbd_status ") or item.name in BOTH_WAYS:
                        continue
                    found = arguments(item, own)
                    if found and found[1]:
                        may_fail = any(status in MAY_FAIL for status in pages.status_list(item.name))
                        yield header.name, item.name, may_fail, found[0], " + ".join(found[1])


def names():
    return [row[1] for row in rows()]


def text():
    """The text of tests/plain_calls.h."""
    out = TEXT + "/* clang-format off */\n"
    for macro, of_body in ("PLAIN_CALLS", False), ("BODY_CALLS", True):
        out += f"\n#define {macro}(CALL)"
        for header, name, may_fail, words, n in rows():
            if ("BODY" in words) == of_body:
                call = f'CALL("{header}", {name}, {int(may_fail)}, ({", ".join(words)}), {n})'
                out += "".join(" \\\n" + line for line in textwrap.wrap(call, 104, initial_indent=4 * " ", subsequent_indent=8 * " "))
        out += "\n"
    return out + "\n#endif\n"


if __name__ == "__main__":
    print(text(), end="")
