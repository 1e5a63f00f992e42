# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""Libraries that a wheel brings compiled, so that its users need no compiler. python/make_wheel.py makes them."""
from __future__ import annotations

import ctypes
import functools
import hashlib
import os
from pathlib import Path

from ._headers import _TEXT

_FOLDER = Path(__file__).resolve().parent / "compiled"
_ENDING = ".dll" if os.name == "nt" else ".so"

# Which of the libraries this machine runs: 0, or on x86-64 what the levels of its psABI have.
_MACHINE = """
int rbd_machine_level(void);
int rbd_machine_level(void) {
#if defined __x86_64__
    __builtin_cpu_init();
    if (__builtin_cpu_supports("x86-64-v4")) return 2;
    if (__builtin_cpu_supports("x86-64-v3")) return 1;
#endif
    return 0;
}
"""


def _stamp():
    """The headers that compiled libraries are of."""
    return hashlib.sha256(_TEXT.encode()).hexdigest()


@functools.lru_cache(maxsize=None)
def _are_there():
    """Whether there are compiled libraries, and of these headers."""
    try:
        return (_FOLDER / "headers.sha256").read_text() == _stamp()
    except OSError:
        return False


@functools.lru_cache(maxsize=None)
def _compiled(name):
    """The compiled library of this name, or None."""
    path = _FOLDER / (name + _ENDING)
    return ctypes.CDLL(str(path)) if _are_there() and path.exists() else None


def _compiled_for_machine(name):
    """The fastest that this machine runs of `name-0`, `name-1`, ..., or None."""
    machine = _compiled("machine")
    levels = range(machine.rbd_machine_level(), -1, -1) if machine else ()
    return next(filter(None, (_compiled(f"{name}-{level}") for level in levels)), None)


@functools.lru_cache(maxsize=None)
def _compiled_loader(kind):
    """The loader of "urdf" or "mjcf" files with the libraries that it stands on, or None."""
    try:
        needed = (_FOLDER / f"{kind}.txt").read_text().split() if _are_there() else []
        for name in needed:  # those that stand on none first: the next ones find them by name
            ctypes.CDLL(str(_FOLDER / name), mode=ctypes.RTLD_GLOBAL)
        return _compiled(kind)
    except OSError:  # no such list, or a system without libstdc++
        return None
