#!/usr/bin/env python3
"""The pages of Python's reference, from the package's signatures and docstrings: pages.py puts them into the site.

usage: python_reference.py      prints them, for tests. Needs numpy. SPDX-License-Identifier: MIT"""
import ast
import enum
import functools
import inspect
import re
import sys

from extract import ROOT

sys.path.insert(0, str(ROOT / "python"))
import rbd  # noqa: E402
import stubs  # noqa: E402

TITLE = {
    "python": "rbd in Python",
    "python_model": "Model",
    "python_objects": "Sets, controllers and libraries",
    "python_rows": "Rows of descriptions",
    "python_results": "Results, statuses and errors",
}


def page_of(name):
    """The page that a public name stands on."""
    thing = getattr(rbd, name)
    if not isinstance(thing, type):
        return "python"
    if thing is rbd.Model:
        return "python_model"
    if hasattr(thing, "__dataclass_fields__"):
        return "python_rows"
    results = issubclass(thing, (tuple, enum.Enum, Exception))
    return "python_results" if results else "python_objects"


# ---- docstrings as Markdown ----

def parts(text):
    """A docstring's parts: ("text", sentences), ("code", lines), ("rows", [[name, words], ...])."""
    found = []
    for line in (text or "").split("\n"):
        indent, last = len(line) - len(line.lstrip()), found[-1] if found else ["", None]
        row = re.match(r" {0,4}([A-Za-z_]\w*(?:, \w+)*|(?= {16})) {2,}(\S.*)$", line)
        if not line.strip():
            found.append(["", None])
        elif row and last[0] != "code":
            if last[0] != "rows":
                found.append(["rows", []])
            found[-1][1].append([row[1], row[2]])
        elif last[0] == "rows" and indent >= 8:
            last[1][-1][1] += " " + line.strip()
        elif indent >= 4:
            if last[0] != "code":
                found.append(["code", ""])
            found[-1][1] += line[4:] + "\n"
        elif last[0] == "text" and not line.startswith("- "):
            last[1] += " " + line.strip()
        else:
            found.append(["text", line.strip()])
    return [part for part in found if part[0]]


def table(rows):
    """Rows of a docstring: those of calls have a shape in the second column."""
    cells = [[name, *re.split(r" {2,}", words, maxsplit=1)] for name, words in rows]
    wide = any(len(row) == 3 for row in cells)
    lines = ["| " * (3 + wide), "|---" * (2 + wide) + "|"]
    for row in cells:
        row = [row[0], "", row[1]] if wide and len(row) == 2 else row
        name = f"`{row[0]}`" if row[0] else ""
        lines.append("| " + " | ".join([name, *(cell.replace("|", "\\|") for cell in row[1:])]) + " |")
    return "\n".join(lines) + "\n"


def markdown(text, linked, owner=None):
    """A docstring; linked: makes links of names of C in a sentence."""
    out = []
    for kind, content in parts(text):
        if kind == "rows":
            out.append(table([[name, referred(linked(words), owner)] for name, words in content]))
        elif kind == "code":
            out.append(f"```python\n{content}```\n")
        else:
            out.append(referred(linked(content), owner) + "\n")
    return "\n".join(out)


@functools.lru_cache(None)
def places():
    """Name, `Class.member` too, and the role of a link to it."""
    found = {name: "func" if inspect.isfunction(getattr(rbd, name)) else "class" for name in rbd.__all__}
    for name in rbd.__all__:
        if isinstance(getattr(rbd, name), type):
            found.update({f"{name}.{member}": "meth" for member in methods(getattr(rbd, name))})
    return found


def referred(text, owner):
    """Text with links from `names` of the package to their entries: of this class first."""
    def link(match):
        name = next((n for n in (f"{owner}.{match[1]}", match[1]) if n in places()), None)
        return f"{{py:{places()[name]}}}`{match[1]} <rbd.{name}>`" if name and name != owner else match[0]
    text = re.sub(r"(?<![\w}`])`([A-Za-z_][\w.]*)`(?!`)", link, text)
    return re.sub(r"\bdocs/(\w+)\.md", lambda found: f"[{found[0]}](/guides/{found[1]}.md)", text)


# ---- entries ----

def methods(cls):
    """Public methods of a class of the package, and properties, by name."""
    if issubclass(cls, (tuple, enum.Enum, Exception)):
        return {}
    return {name: member for name, member in stubs.members(cls).items() if not name.startswith("_") and (
        inspect.isfunction(member) or isinstance(member, (property, classmethod)))}


def signature(member, typed=True):
    """Its signature as text, without self and without the types of arrays; or without any types."""
    call = getattr(member, "_rbd_call", None)
    found = inspect.signature(getattr(member, "__func__", member))
    found = stubs.call_signature(call, member) if call else found
    kept = [p for p in found.parameters.values() if p.name not in ("self", "cls")]
    kept = [p if typed and not str(p.annotation).startswith("ArrayLike") else p.replace(annotation=p.empty) for p in kept]
    text = []
    for k, p in enumerate(kept):
        before = kept[k - 1].kind if k else None
        text += ["*"] if p.kind is p.KEYWORD_ONLY and before not in (p.KEYWORD_ONLY, p.VAR_POSITIONAL) else []
        text.append("*" * (p.kind is p.VAR_POSITIONAL) + p.name + annotated(p))
    result = found.return_annotation
    return f"({', '.join(text)})" + (f" -> {result}" if result not in (found.empty, None, "None") else "")


def annotated(parameter):
    """Type and default of a parameter."""
    typed = parameter.annotation is not parameter.empty
    text = f": {parameter.annotation}" if typed else ""
    if parameter.default is not parameter.empty:
        text += (" = " if typed else "=") + repr(parameter.default)
    return text


def fields(name):
    """Rows of a class's fields and attributes: name, type, default and comment."""
    try:
        text = stubs.source(name)
    except KeyError:
        return
    lines = text.split("\n")
    for node in ast.parse(text).body[0].body:
        if not isinstance(node, (ast.AnnAssign, ast.Assign)):
            continue
        target = node.target if isinstance(node, ast.AnnAssign) else node.targets[0]
        comment = re.search(r"#: (.*)", lines[node.end_lineno - 1])
        if not target.id.startswith("_"):
            kind = ast.unparse(node.annotation) if isinstance(node, ast.AnnAssign) else ""
            yield target.id, kind, ast.unparse(node.value) if node.value else "", comment[1] if comment else ""


def field_table(name, linked):
    """The fields as a table; of an inherited class too."""
    rows = []
    for part in reversed(getattr(rbd, name).__mro__):
        rows += fields(part.__name__) if part.__module__.partition(".")[0] == "rbd" else []
    if not rows:
        return ""
    defaults = any(row[2] for row in rows)
    lines = ["| | type | " + "default | " * defaults + "|", "|---|---|---|" + "---|" * defaults]
    for field, kind, default, comment in rows:
        kind = kind.replace("|", "\\|")
        cells = [f"`{field}`", f"`{kind}`" if kind else ""] + [f"`{default}`" if default else ""] * defaults
        lines.append("| " + " | ".join([*cells, linked(comment).replace("|", "\\|")]) + " |")
    return "\n".join(lines) + "\n"


def enumeration(thing, linked):
    """Values of an enumeration, with the one of C that they are of."""
    name = "rbd_" + re.sub(r"(?<=[a-z])(?=[A-Z])", "_", thing.__name__).lower()
    rows = "\n".join(f"| `{member.name}` | {member.value} |" for member in thing)
    return f"The values of {linked(name)}, which says what they mean.\n\n| | |\n|---|--:|\n{rows}\n"


def class_entry(name, linked):
    """A class with its fields and its methods."""
    thing = getattr(rbd, name)
    if issubclass(thing, enum.Enum):
        return f"`````{{py:class}} rbd.{name}\n\n{enumeration(thing, linked)}\n`````\n"
    made = signature(thing.__init__, typed=page_of(name) != "python_rows")
    made = "" if issubclass(thing, (tuple, Warning)) or thing in (rbd.Spatial, rbd.Picture) else made  # others make them
    kind = "exception" if issubclass(thing, Exception) else "class"
    out = [f"`````{{py:{kind}}} rbd.{name}{made}\n", markdown(inspect.getdoc(thing), linked, name), field_table(name, linked)]
    for method, member in methods(thing).items():
        if isinstance(member, property):
            role, head = "property", f"{method}\n:type: {inspect.signature(member.fget).return_annotation}"
        else:
            role, head = "classmethod" if isinstance(member, classmethod) else "method", method + signature(member)
        member = getattr(member, "__func__", member)
        out.append(f"````{{py:{role}}} {head}\n\n{markdown(inspect.getdoc(member), linked, name)}\n````\n")
    return "\n".join(out) + "`````\n"


def function_entry(name, linked):
    thing = getattr(rbd, name)
    if not inspect.isfunction(thing):
        return f"`````{{py:data}} rbd.{name}\n\nThe folder of the headers and models that the package has.\n`````\n"
    return f"`````{{py:function}} rbd.{name}{signature(thing)}\n\n{markdown(inspect.getdoc(thing), linked)}\n`````\n"


def what(name):
    """A public name in a few words."""
    thing = getattr(rbd, name)
    if not isinstance(thing, type) and not inspect.isfunction(thing):
        return "folder of the headers and models"
    return "enumeration" if isinstance(thing, type) and issubclass(thing, enum.Enum) else summary(thing)


# ---- pages ----

def pages(of_c):
    """Name and text of each page; of_c: makes links of names of C in a sentence."""
    def linked(text):
        return of_c(re.sub(r"\brbd(_\w+)?\.h\b", r"`\g<0>`", text))

    texts = {page: [f"# {title}\n"] for page, title in TITLE.items()}
    texts["python"].append(markdown(inspect.getdoc(rbd), linked))
    rows = [f"| {{py:{places()[name]}}}`{name} <rbd.{name}>` | {linked(what(name))} |"
            for name in rbd.__all__ if name != "SOURCES"]
    texts["python"] += ["| name | |", "|---|---|", *rows, ""]
    for name in rbd.__all__:
        entry = class_entry if isinstance(getattr(rbd, name), type) else function_entry
        texts[page_of(name)].append(entry(name, linked))
    calls = [f"| {{py:meth}}`{name} <rbd.Model.{name}>` | {linked(summary(member))} |" for name, member in methods(rbd.Model).items()]
    texts["python_model"][1:1] = ["| call | |", "|---|---|", *calls, ""]
    return {f"reference/{page}": "\n".join(text) for page, text in texts.items()}


def summary(member):
    """The first sentence of its docstring."""
    text = " ".join((inspect.getdoc(getattr(member, "__func__", member)) or "").split("\n\n")[0].split())
    return re.split(r"(?<!ch)\. (?=[A-Z`(])", text)[0].rstrip(".:").replace("|", "\\|")


if __name__ == "__main__":
    print("\n".join(pages(str).values()))
