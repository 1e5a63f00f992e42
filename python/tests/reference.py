# SPDX-License-Identifier: MIT
"""The reference results of tests/data: unpacked as C, compiled, and read by what reference.h says."""
import ctypes
import functools
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace

import numpy as np

import rbd
from rbd._compiling import _c_compiler, _compile
from rbd._descriptions import _from_c
from rbd._headers import _TEXT

TESTS = rbd.SOURCES / "tests"
_HEADER = (TESTS / "data/reference.h").read_text()


@functools.lru_cache(maxsize=None)
def _pointers(struct):
    """Of each pointer member what it points to, and its shape: {"M": ("double", ["nv", "nv"])}."""
    body = re.search(rf"typedef struct {struct} \{{(.*?)\n\}} {struct};", _HEADER, re.S)[1]
    return {member: (kind, re.split(" x ", re.match("[^:;]*", comment)[0])) for kind, member, comment in
            re.findall(r"const (\w+) \*(\w+);\s*/\* (.*?) \*/", body)}


def _structure(name):
    return rbd.structure(name, text=_TEXT + _HEADER)


def _read(name, row, dims):
    """A C struct as a namespace: arrays with their shapes, structures that it points to as lists."""
    found = SimpleNamespace()
    for member, kind in row._fields_:
        value = getattr(row, member)
        if kind is ctypes.c_char_p:
            value = value.decode() if value else None
        elif isinstance(value, ctypes.Array):
            value = np.array(value)
        elif kind is ctypes.c_void_p and value is not None:
            declared, shape = _pointers(name)[member]
            numbers = {**dims, **vars(getattr(found, "model", found)), **vars(found)}
            value = _pointed(value, declared, shape, numbers)
        setattr(found, member, value)
    return found


def _pointed(address, declared, shape, numbers):
    """What a pointer leads to."""
    if declared == "ref_model":
        return _read(declared, ctypes.cast(address, ctypes.POINTER(_structure(declared)))[0], {})
    shape = [int(length) if length.isdigit() else numbers[length] for length in shape]
    c_type = {"double": ctypes.c_double, "int": ctypes.c_int}.get(declared)
    if c_type:
        return np.ctypeslib.as_array(ctypes.cast(address, ctypes.POINTER(c_type)), shape=shape).copy()
    rows = ctypes.cast(address, ctypes.POINTER(_structure(declared)))
    if declared == "rbd_body":
        return [_from_c(rows[k]) for k in range(shape[0])]
    return [_read(declared, rows[k], numbers) for k in range(shape[0])]


@functools.lru_cache(maxsize=None)
def _library():
    units = []
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, str(TESTS / "data/unpack.py"), folder], check=True)
        for name in "reference", "control":
            data = Path(folder, f"{name}_models.h").read_text()
            source = (TESTS / f"{name}.c").read_text()
            units.append(source.replace(f'#include "{name}_models.h"', data))
    return _compile(units, [*_c_compiler(), "-O0", f"-I{TESTS}"])


def _all(struct, count, get):
    library = _library()
    getter = getattr(library, get)
    getter.restype = ctypes.POINTER(_structure(struct))
    return [_read(struct, getter(k)[0], {}) for k in range(ctypes.c_int.in_dll(library, count).value)]


@functools.lru_cache(maxsize=None)
def models():
    """All that are not of control: each with its bodies and states."""
    return _all("ref_model", "reference_count", "reference_model")


@functools.lru_cache(maxsize=None)
def controls():
    """What controllers ask, and constraints."""
    return _all("ref_control", "control_count", "reference_control")
