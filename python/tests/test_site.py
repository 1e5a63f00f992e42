# SPDX-License-Identifier: MIT
"""Each public name has an entry in Python's reference on the site, with its arguments, fields and meaning."""
import dataclasses
import enum
import inspect
import re
import subprocess
import sys

import pytest

import rbd

GENERATOR = rbd.SOURCES / "docs/site/python_reference.py"


@pytest.fixture(scope="module")
def entries():
    """Head and text of each entry, by name: `Model`, `Model.rnea`."""
    pages = subprocess.run([sys.executable, "-B", str(GENERATOR)], stdout=subprocess.PIPE, text=True, check=True).stdout
    found, owner = {}, ""
    for block in re.split(r"^(?=`{4,5}\{py:)", pages, flags=re.M)[1:]:
        ticks, name, head, text = re.match(r"(`+)\{py:\w+\} (?:rbd\.)?(\w+)(.*?)\n(.*)", block, re.S).groups()
        owner = name if len(ticks) == 5 else owner
        found[name if len(ticks) == 5 else f"{owner}.{name}"] = head, text
    return found


def public(cls):
    """Methods and properties that the package defines."""
    return {name: member for part in cls.__mro__ if part.__module__.partition(".")[0] == "rbd" for name, member in vars(part).items()
            if not name.startswith("_") and (inspect.isfunction(member) or isinstance(member, (property, classmethod)))}


def test_every_public_name(entries):
    """And no other."""
    expected = set(rbd.__all__)
    for name in rbd.__all__:
        thing = getattr(rbd, name)
        if isinstance(thing, type) and not issubclass(thing, (tuple, enum.Enum, Exception)):
            expected |= {f"{name}.{member}" for member in public(thing)}
    assert set(entries) == expected and len(expected) > 200


def test_signatures(entries):
    """Each argument is in the head, in its order."""
    checked = 0
    for name, (head, text) in entries.items():
        owner, _, member = name.rpartition(".")
        thing = public(getattr(rbd, owner))[member] if owner else getattr(rbd, name)
        thing = getattr(thing, "__func__", thing)
        if inspect.isfunction(thing):
            names = [p for p in inspect.signature(thing).parameters if p not in ("self", "cls")]
            places = [re.search(rf"[(, *]{p}\b", head).start() for p in names]
            assert places == sorted(places), name
            assert len(text.strip("`\n ")) > 10, f"{name} says nothing"
            checked += 1
    assert checked > 160


def test_shapes_and_meanings(entries):
    """Of the arguments and results of calls that C computes, and of all fields and values."""
    for name in (name for name in entries if name.startswith(("Model.", "ConstraintSet.", "ContactSet."))):
        owner, member = name.split(".")
        call = getattr(public(getattr(rbd, owner))[member], "_rbd_call", None)
        for quantity in (call.inputs + call.outputs if call else ()):
            shape = call.shapes[quantity].replace(" ", " x ").replace("-", "")
            row = rf"^\| `{quantity}` \| {shape} \| .+ \|$" if shape else rf"^\| `{quantity}` \|( +\|)? .+ \|$"
            assert re.search(row, entries[name][1], re.M), f"{name}: {quantity}"
    for name in rbd.__all__:
        thing = getattr(rbd, name)
        names = [f.name for f in dataclasses.fields(thing)] if dataclasses.is_dataclass(thing) else \
            [value.name for value in thing] if isinstance(thing, type) and issubclass(thing, enum.Enum) else getattr(thing, "_fields", [])
        for part in names:
            assert f"| `{part}` |" in entries[name][1], f"{name}.{part}"
