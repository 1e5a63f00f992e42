# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""C tables for firmware, by the writers of rbd-model."""
from __future__ import annotations

import ctypes
import os
import re
import tempfile
import threading
from pathlib import Path

from ._compiled import _compiled
from ._compiling import _QUICK, _c_compiler, _compile
from ._descriptions import _rows
from ._headers import SOURCES

# They print to standard output; here to a file.
_TO_FILE = """
#include <stdio.h>
extern FILE *rbd_out;
#define printf(...) fprintf(rbd_out, __VA_ARGS__)
#define putchar(c) fputc(c, rbd_out)
"""
_PRINT = """
#include <stdio.h>
#include <stdlib.h>
#define RBD_IMPLEMENTATION
#include "rbd_constraints.h"
#include "tools/print.h"

FILE *rbd_out;
const char *program = "rbd";
void *grown(void *memory, size_t size) {
    if (!(memory = realloc(memory, size))) abort();
    return memory;
}
void *allocate(size_t n, size_t size) {
    void *memory = calloc(n ? n : 1, size ? size : 1);
    if (!memory) abort();
    return memory;
}

int rbd_print(const char *path, int built, const char *name, const char *source, rbd_body *bodies, int nb,
              int kinematic, const double gravity[3]) {
    rbd_urdf_frame root = {0};
    robot r = {0};
    size_t size = rbd_model_size(bodies, nb);
    r.model_memory = allocate(size, 1);
    r.kinematic = kinematic;
    if (rbd_model_build_kinematic(bodies, nb, r.model_memory, size, &r.model, NULL) == RBD_OK &&
        (rbd_out = fopen(path, "w"))) {
        rbd_model *m = (rbd_model *)r.model;
        m->gravity.x = gravity[0], m->gravity.y = gravity[1], m->gravity.z = gravity[2];
        root.body = bodies[0].type == RBD_FLOATING ? 0 : -1;
        r.path = source, r.urdf.name = name, r.urdf.bodies = bodies, r.urdf.nb = nb, r.urdf.frames = &root;
        (built ? print_c_model : print_c)(&r, name);
        built = ferror(rbd_out) | fclose(rbd_out) ? -1 : 0;
    } else {
        built = -1;
    }
    free(r.model_memory);
    return built;
}
"""
_print_lock = threading.Lock()


def _print_units():
    files = ("print", "print_c", "print_c_indices", "print_c_model")
    return [_PRINT, *(f'{_TO_FILE}#line 1 "{file}.c"\n' + (SOURCES / f"tools/{file}.c").read_text()
                      for file in files)]


def _print_flags():
    return [*_QUICK, "-ffp-contract=off", f"-I{SOURCES / 'tools'}"]


def _print_c(model, name, source, built):
    """The text that rbd-model writes of this robot. It builds anew, in double, from the description."""
    for what, text in ("name", name), ("source", source):
        if not isinstance(text, str):
            raise TypeError(f"{what} must be text, not {text!r}")
    if not re.fullmatch(r"[A-Za-z_]\w*", name, re.A):
        raise ValueError(f"{name!r} is not a C identifier")
    library = _compiled("print") or _compile(_print_units(), [*_c_compiler(), *_print_flags()], ["-lm"])
    rows = _rows(model.bodies)
    gravity = (ctypes.c_double * 3)(*model.get_gravity())
    with tempfile.TemporaryDirectory() as folder, _print_lock:
        path = Path(folder, "table.h")
        if library.rbd_print(os.fsencode(path), built, name.encode(), source.encode(), rows, len(rows),
                             model.kinematic, gravity):
            raise RuntimeError(f"{path}: cannot be written")
        return path.read_text()
