# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""The C compiler: shared libraries of texts, kept in a cache."""
from __future__ import annotations

import ctypes
import hashlib
import os
import shlex
import signal
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

from ._headers import SOURCES, _TEXT


def _run(command):
    """Runs a compiler or the like and gives what it prints. An error says which command, how it ended, and
    what it printed."""
    try:
        done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, errors="replace")
    except OSError as error:
        raise RuntimeError(f"rbd needs '{command[0]}': {error.strerror}") from None
    if done.returncode:
        status = done.returncode
        try:
            ended = f"exit status {status}" if status > 0 else f"killed by {signal.Signals(-status).name}"
        except ValueError:
            ended = f"killed by signal {-status}"
        if status == -getattr(signal, "SIGKILL", 0):  # Windows has none
            ended += " (out of memory?)"
        printed = done.stdout.strip()
        raise RuntimeError(f"{shlex.join(command)}: {ended}; it printed" +
                           (f":\n{printed}" if printed else " nothing"))
    return done.stdout


# For code that computes no dynamics: without forced inlining the headers compile in a third of the time.
_QUICK = ["-O0"]


def _c_compiler():
    """The C compiler where none is named, as a list of words."""
    return _words("$CC", os.environ.get("CC", "").strip() or "cc")


def _words(name, text):
    """A command or flags, text as in a shell, as a list of words."""
    if not isinstance(text, str):
        raise TypeError(f"{name} must be text, as in a shell, not {text!r}")
    try:
        return shlex.split(text)
    except ValueError as error:
        raise ValueError(f"{name}: {error}: {text!r}") from None


def _cache():
    """The folder of compiled libraries."""
    caches = Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache").expanduser()
    folder = Path(os.environ.get("RBD_CACHE") or caches / "rbd")
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError as error:
        raise RuntimeError(f"{folder}: {error.strerror}; "
                           "set $RBD_CACHE to a folder for compiled libraries") from None
    return folder


def _compile(units, command, libraries=(), what=""):
    """A shared library of the units, texts of C or C++, from the cache if it is there. Its name is the hash
    of all inputs. It is moved into its place when complete, so that several processes may do this at once.
    `what` is said on standard error beforehand."""
    language = "c++" if "++" in command[0] else "c"
    # The compiler's macros tell its version, and what -march=native is on this machine.
    machine = _run([*command, "-dM", "-E", "-x", language, os.devnull])
    digest = hashlib.sha256("\0".join([machine, *command, *libraries, *units, _TEXT]).encode())
    path = _cache() / f"{digest.hexdigest()[:32]}.so"
    if path.exists():
        return ctypes.CDLL(str(path))
    if what and not os.environ.get("RBD_QUIET"):
        print(f"rbd: compiling {what}; this is done once, the result is kept: {path} "
              "(RBD_QUIET=1 hides this line)", file=sys.stderr, flush=True)
    with tempfile.TemporaryDirectory(dir=path.parent) as folder:
        objects = [f"{folder}/{k}.o" for k in range(len(units))]

        def compile_unit(number):
            source = f"{folder}/{number}.{language}"
            Path(source).write_text(units[number])
            try:
                _run([*command, "-fPIC", f"-I{SOURCES}", "-x", language, "-c", source, "-o", objects[number]])
            except RuntimeError as error:
                failures.append(error)

        failures = []
        threads = [threading.Thread(target=compile_unit, args=(k,)) for k in range(len(units))]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        if failures:
            raise failures[0]
        _run([*command, "-shared", *objects, "-o", f"{folder}/library", *libraries])
        try:
            os.replace(f"{folder}/library", path)
        except FileNotFoundError:
            raise RuntimeError(f"'{shlex.join(command)}' wrote no library: is it a compiler?") from None
    return ctypes.CDLL(str(path))
