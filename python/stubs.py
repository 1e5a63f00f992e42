# SPDX-License-Identifier: MIT
"""Writes the type stubs, from which editors and mypy know the calls, their arguments and results.

    usage: stubs.py [FILE]      FILE: rbd/__init__.pyi beside this script, where git ignores it

The package itself is the source: its tables of calls and quantities, its annotations and its docstrings. setup.py
puts the stubs into what is installed."""
import ast
import enum
import inspect
import re
import sys
import textwrap
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import rbd  # noqa: E402
from rbd import _spatial  # noqa: E402

SOURCES = [(text, ast.parse(text)) for text in (path.read_text() for path in sorted((HERE / "rbd").glob("*.py")))]

HEAD = '''# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
# Made by stubs.py: do not edit.
import ctypes
import os
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path
from typing import Any, Iterable, Literal, Mapping, NamedTuple, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[Any]
Numbers = Union[Sequence[float], Array]
Matrix = Sequence[Sequence[float]]
_MaybeNone = Any  # None where a keyword leaves the result out

'''
INPUTS = {"body": "int | str", "reference": "int | str", "axes": 'Literal["world", "link"]'}


def hidden_lines(node):
    """Lines of a class that a stub has not: private methods, and what the others do behind their docstring."""
    hidden = set()
    for method in (part for part in node.body if isinstance(part, ast.FunctionDef)):
        inside = [method] if method.name.startswith("_") else method.body[1:]
        for part in inside:
            hidden |= set(range(part.lineno, part.end_lineno + 1))
    return hidden


def source(name):
    """The text of a class, wherever the package has it."""
    for text, tree in SOURCES:
        for node in tree.body:
            if isinstance(node, ast.ClassDef) and node.name == name:
                first = min(node.lineno, *(d.lineno for d in node.decorator_list or [node]))
                lines = enumerate(text.split("\n")[first - 1:node.end_lineno], first)
                hidden = hidden_lines(node)
                kept = "\n".join(line for number, line in lines if number not in hidden).rstrip() + "\n"
                return kept.replace("(_Declared):", ":", 1)  # which only refuses what a type checker sees
    raise KeyError(name)


def members(cls):
    """What a class and the parts that it inherits define, by name."""
    return {name: member for part in reversed(cls.__mro__) if part.__module__.split(".")[0] == "rbd"
            for name, member in vars(part).items()}


def docstring(text):
    """A docstring, not indented; nothing if there is no text."""
    return f'"""{inspect.cleandoc(text)}"""\n' if text else ""


def function(name, signature, doc, decorator=""):
    """A function of this signature, whose annotations are text."""
    parts, star = [], False
    for p in signature.parameters.values():
        if p.kind is p.KEYWORD_ONLY and not star:
            parts.append("*")
        star = star or p.kind in (p.KEYWORD_ONLY, p.VAR_POSITIONAL)
        text = "*" * (p.kind is p.VAR_POSITIONAL) + p.name
        if p.annotation is not p.empty:
            text += f": {p.annotation}"
        if p.default is not p.empty:
            default = "..." if isinstance(p.default, type) else repr(p.default)
            text += f" = {default}" if ":" in text else f"={default}"
        parts.append(text)
    result = "None" if signature.return_annotation is signature.empty else signature.return_annotation
    ends = [","] * (len(parts) - 1) + [f") -> {result}:"]
    lines = [f"def {name}("]
    for part, end in zip(parts or [""], ends):
        if len(lines[-1]) + len(part) + len(end) > 104:
            lines.append(" " * len(f"def {name}("))
        lines[-1] += (" " if lines[-1].endswith(",") else "") + part + end
    body = textwrap.indent(docstring(doc) or "...\n", "    ")
    return decorator + "\n".join(lines) + "\n" + body


def call_signature(call, method):
    """The signature of a call of the tables, with types."""
    parameters = []
    for p in inspect.signature(method).parameters.values():
        kind = p.empty
        if p.name in call.inputs:
            kind = INPUTS.get(p.name, "ArrayLike") + " | None" * (p.name in call.optional)
        elif p.kind is p.KEYWORD_ONLY:
            kind = "bool"
        parameters.append(p.replace(annotation=kind))
    result = (call.tuple.__name__ if call.tuple else
              "None" if not call.outputs else output(call, call.outputs[0], call.flags[0]))
    return inspect.Signature(parameters, return_annotation=result)


def output(call, name, flag):
    """The type of a result."""
    kind = "float" if call.shapes[name] == "-" else "Array"
    return kind + " | _MaybeNone" * (flag is not None)


def result_tuples():
    """The named tuples of the calls."""
    calls = [method._rbd_call for owner in (rbd.Model, rbd.ConstraintSet, rbd.ContactSet)
             for method in members(owner).values() if hasattr(method, "_rbd_call")]
    fields = {call.tuple: [output(call, *x) for x in zip(call.outputs, call.flags)]
              for call in calls if call.tuple}
    for kind in rbd.hybrid_results, rbd.batch_momentum_results:
        fields[kind] = ["Array"] * len(kind._fields)
    for kind, types in fields.items():
        lines = "".join(f"    {name}: {of}\n" for name, of in zip(kind._fields, types))
        yield f"class {kind.__name__}(NamedTuple):\n{lines}"


def spatial_methods():
    """The methods of Spatial, from its table."""
    kinds = {"placement": "tuple[ArrayLike, ArrayLike]"}
    results = {"number": "float", "placement": "Placement", "axis_angle": "AxisAngle"}
    for name, (parameters, result, _, _) in _spatial._SPATIAL.items():
        place = inspect.Parameter.POSITIONAL_OR_KEYWORD
        arguments = [inspect.Parameter("self", place)] + [
            inspect.Parameter(p, place, annotation=kinds.get(kind, "ArrayLike")) for p, kind in parameters]
        yield function(name, inspect.Signature(arguments, return_annotation=results.get(result, "Array")),
                       getattr(rbd.Spatial, name).__doc__)


def attributes(cls):
    """The annotated attributes of a class, with their comments."""
    head = source(cls.__name__).partition("    def ")[0]
    return "".join(re.findall(r"^    (\w+: .*\n)", re.sub(r'""".*?"""', "", head, flags=re.S), re.M))


def methods(cls):
    """The public methods of a class."""
    for name, member in members(cls).items():
        if name.startswith("_") and name != "__init__" or name in _spatial._SPATIAL and cls is rbd.Spatial:
            continue
        if isinstance(member, property):
            yield function(name, inspect.signature(member.fget), member.__doc__, "@property\n")
        elif isinstance(member, classmethod):
            yield function(name, inspect.signature(member.__func__), member.__doc__, "@classmethod\n")
        elif hasattr(member, "_rbd_call"):
            yield function(name, call_signature(member._rbd_call, member), member.__doc__)
        elif inspect.isfunction(member):
            yield function(name, inspect.signature(member), member.__doc__)


def definition(name):
    """The stub of a public name."""
    thing = getattr(rbd, name)
    if isinstance(thing, Path):
        return f"{name}: Path\n"
    if inspect.isfunction(thing):
        return function(name, inspect.signature(thing), thing.__doc__)
    if issubclass(thing, enum.Enum):
        members = "".join(f"    {member.name} = {member.value}\n" for member in thing)
        return f"class {name}(IntEnum):\n{members}"
    if issubclass(thing, tuple) or hasattr(thing, "__dataclass_fields__"):
        return source(name)
    bases = f"({thing.__base__.__name__})" if issubclass(thing, Exception) else ""
    inside = [docstring(thing.__doc__) + attributes(thing), *methods(thing)]
    if thing is rbd.Spatial:
        inside += spatial_methods()
    return f"class {name}{bases}:\n" + textwrap.indent("\n".join(inside), "    ")


def bases(name):
    """How many classes of the package a public class inherits: mypy reads those first."""
    return sum(part.__module__.split(".")[0] == "rbd" for part in getattr(getattr(rbd, name), "__mro__", ())[1:])


def text():
    """The stubs."""
    names = "__all__ = [\n" + "".join(f'    "{name}",\n' for name in rbd.__all__) + "]\n"
    parts = [HEAD + names + "__version__: str\n", *map(definition, sorted(rbd.__all__, key=bases)), *result_tuples()]
    return "\n\n".join(part.rstrip("\n") + "\n" for part in parts)


if __name__ == "__main__":
    if len(sys.argv) > 2 or sys.argv[-1].startswith("-"):
        sys.exit(__doc__)
    Path(*sys.argv[1:] or [HERE / "rbd/__init__.pyi"]).write_text(text())
