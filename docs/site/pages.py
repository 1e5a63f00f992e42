#!/usr/bin/env python3
"""Writes the sources of the site, for Sphinx: pages.py FOLDER; pages.py --check compares only; pages.py --main FAMILY
writes a program that calls the snippets of a family.

The reference comes from the headers' comments (extract.py); the short line of each name from docs/interface.md; shapes
of arguments from python/rbd/_arguments.py; costs from bench/instructions.csv; formulas, arguments of C alone and snippets
from this folder. Guides are docs/*.md and the README files, with their links made fit. SPDX-License-Identifier: MIT"""
import csv
import functools
import html
import os
import pathlib
import re
import sys

import extract
from extract import ROOT

HERE = pathlib.Path(__file__).resolve().parent
# Guides, in order: title of the part, and files; those that are not there are left out.
GUIDES = [
    ("Begin", ["docs/first_minutes.md", "docs/install.md", "docs/robot.md", "docs/robot_files.md", "docs/mjcf.md",
               "docs/which_call.md", "docs/conventions.md", "examples/README.md", "python/README.md", "docs/faq.md", "docs/glossary.md"]),
    ("An arm", ["docs/gravity_compensation.md", "docs/computed_torque.md", "docs/inverse_kinematics.md", "docs/actuators.md",
                "docs/identification.md"]),
    ("A robot with legs", ["docs/floating_base.md", "docs/contacts.md", "docs/contact_step.md", "docs/qp.md",
                           "docs/tasks.md", "docs/gradients.md", "docs/predictive_control.md"]),
    ("On the robot", ["docs/control_loop.md", "docs/porting.md", "docs/firmware.md", "examples/firmware/README.md",
                      "docs/reproducible.md", "docs/generated_code.md"]),
    ("Research", ["docs/comparison.md", "docs/other_libraries.md", "docs/gpu.md", "docs/tools.md", "models/README.md", "docs/accuracy.md",
                  "docs/accuracy_tables.md",
                  "docs/performance.md", "bench/results/2026-11-27-xeon/report.md",
                  "bench/results/2026-11-27-contact/contact.md", "bench/results/2026-11-27-h200/report.md", "bench/README.md"]),
    ("The project", ["README.md", "CHANGELOG.md", "docs/migration.md", "CONTRIBUTING.md", "packaging/README.md"]),
]
# Titles that are not those of their files, in the menu and on the page.
TITLES = {"docs/mjcf.md": "MJCF files", "examples/firmware/README.md": "Firmware: examples", "bench/results/2026-11-27-xeon/report.md": "Measurements",
          "bench/results/2026-11-27-contact/contact.md": "Measurements of contacts",
          "bench/results/2026-11-27-h200/report.md": "Measurements on a GPU", "README.md": "Overview"}
# Pages that no menu needs: they are reached by links.
HIDDEN = ["docs/migration.md"]
# The four doors of the first page: who comes, and the guides for it.
DOORS = [
    ("An arm", "Torques that carry its weight, motions that follow a path, a hand at a place.",
     ["docs/gravity_compensation.md", "docs/computed_torque.md", "docs/inverse_kinematics.md"]),
    ("A robot with legs", "A base that floats, feet that stand, slip and land, forces within friction.",
     ["docs/floating_base.md", "docs/contacts.md", "docs/contact_step.md", "docs/tasks.md"]),
    ("A microcontroller", "No heap, the model in flash, the same code in float: what it costs, and how to bring it to your board.",
     ["docs/firmware.md", "docs/porting.md", "examples/firmware/README.md"]),
    ("Research", "Derivatives, predictive control, thousands of states at once, a GPU, and rbd beside other libraries.",
     ["docs/comparison.md", "docs/predictive_control.md", "docs/gpu.md", "python/README.md"]),
]
# Rows of bench/instructions.csv, and the call that each is of.
COSTS = {"id": "rbd_rnea", "mm": "rbd_crba", "mm_packed": "rbd_crba_packed", "fd": "rbd_aba",
         "fd_cholesky": "rbd_fd_cholesky", "hybrid": "rbd_hybrid", "id_free_base": "rbd_id_free_base",
         "minv": "rbd_minverse", "jacobian": "rbd_jacobian", "body_jacobian": "rbd_body_kinematics",
         "momentum_matrix": "rbd_momentum_matrix",
         "coriolis": "rbd_coriolis", "regressor": "rbd_regressor", "id_derivatives": "rbd_id_derivatives",
         "id_derivatives_mm": "rbd_id_derivatives", "fd_derivatives": "rbd_fd_derivatives",
         "constrained_fd": "rbd_constrained_fd", "constrained_fd_hand": "rbd_constrained_fd"}
COST_NOTES = {"jacobian": "with rbd_kinematics", "body_jacobian": "with pose and Jacobian", "id_derivatives_mm": "with M", "constrained_fd": "12 rows",
              "constrained_fd_hand": "with a hand held too"}
# Arguments of these types need no further word.
HANDLES = {"rbd_model": "the model", "rbd_work": "work of this thread", "rbd_derivatives": "memory of derivatives",
           "rbd_constraint_set": "the set", "rbd_contact_set": "the set", "rbd_batch": "memory of the batch",
           "rbd_batch_derivatives": "memory of derivatives", "rbd_batch_constraint_set": "the set"}


# ---- what is known of a name ----

def table(name, columns):
    """Rows of a text file of this folder: columns that two blanks separate."""
    rows = [line for line in (HERE / name).read_text().splitlines() if line and not line.startswith("#")]
    return [re.split(r" {2,}", row, maxsplit=columns - 1) for row in rows]


@functools.lru_cache(None)
def headers():
    return [extract.parse(name) for name in extract.HEADERS]


@functools.lru_cache(None)
def formulas():
    return dict(table("formulas.txt", 2))


@functools.lru_cache(None)
def summaries():
    """Name and short line, of docs/interface.md."""
    found = {}
    for names, what in re.findall(r"^\| (`[^|]*) \| ([^|]*) \|", (ROOT / "docs/interface.md").read_text(), re.M):
        for name in re.findall(r"`(\w+)", names):
            found.setdefault(name, what)
    return found


@functools.lru_cache(None)
def quantities():
    """Name, shape and meaning, of the Python module's table."""
    text = (ROOT / "python/rbd/_arguments.py").read_text()
    rows = re.search(r'_QUANTITIES = \{.*?"""\n(.*?)\n"""', text, re.S)[1].splitlines()
    return {row[0]: (row[1], row[2].replace("None", "NULL")) for row in (re.split(r"\s{2,}", line) for line in rows)}


@functools.lru_cache(None)
def arguments():
    return {(call, name): (shape, text) for call, name, shape, text in table("arguments.txt", 4)}


def argument(call, name, own):
    """Shape and meaning of an argument, or None; and the row of arguments.txt that it took."""
    for key in ((call, name), (re.sub("^rbd_batch_", "rbd_", call), name), ("*", name)):
        if key in arguments():
            shape, text = arguments()[key]
            return (quantities()[text] if shape == "=" else (shape, own or text)), key
        if key[0] != "*" and name in quantities() and ("*", name) not in arguments():
            continue
    return (quantities().get(name) if not own else (quantities().get(name, ("-", ""))[0], own)), None


@functools.lru_cache(None)
def costs():
    found = {}
    with open(ROOT / "bench/instructions.csv", newline="") as file:
        for row in csv.DictReader(file):
            if row["compiler"].startswith("gcc") and row["scalar"] == "double" and row["variant"] == "run-time":
                found.setdefault(row["algorithm"], {})[row["robot"]] = int(row["instructions"])
    return found


@functools.lru_cache(None)
def snippets():
    """Call and (file, line, body): each example_NAME of the snippets."""
    found = {}
    for path in sorted((HERE / "snippets").glob("*.c")):
        for match in re.finditer(r"^void example_(\w+)\(void\) \{(?: ([^\n]*) \}|\n(.*?)\n\})$", path.read_text(), re.S | re.M):
            body = match[2] or "\n".join(line[4:] for line in match[3].split("\n"))
            found[match[1]] = (path, body)
    return found


def snippet(name):
    """The example of a call: its own, or the first that calls it."""
    if name in snippets():
        return snippets()[name]
    return next((s for s in snippets().values() if re.search(rf"\b{name}\(", s[1])), None)


@functools.lru_cache(None)
def places():
    """Name and (page, kind) of all that has a place in the reference."""
    found = {}
    for header in headers():
        for name in extract.named_in_top(header):
            found[name] = (page_of(header, None), "macro")
        for section in header.sections:
            for item in section.items:
                found.setdefault(item.name, (page_of(header, section), {"function": "func"}.get(item.kind, item.kind)))
                for declaration, _ in item.members:
                    if item.text.startswith("typedef enum"):
                        found[declaration.split()[0]] = (page_of(header, section), "enumerator")
    return found


def page_of(header, section):
    """rbd.h has a page for each section, other headers have one."""
    stem = header.name.replace(".h", "")
    if header.name == "rbd.h" and section and section.tag:
        return f"reference/{stem}_{section.tag.replace(' ', '_')}"
    return f"reference/{stem}"


def errors(text):
    """Statuses that a comment says a call returns; whether those of its section count too."""
    text = " ".join(text.split())
    found, add = [], True
    for start in re.finditer(r"\b(Errors?(?: of these \w+)?(?:, [^:.]*)?:|Also (?=RBD_ERR|_))", text):
        sentence = re.split(r"\.(?= [A-Z]|$)", text[start.end():])[0]
        if start[1].startswith("Error") and not re.match(r" (also|as) ", sentence):
            add = False
        for call in re.findall(r"\bas (rbd_\w+)", sentence):
            found += [s for s in status_list(call) if s not in found]
        sentence = re.sub(r"(; _|, and RBD_ERR_)SINGULAR[^.]*where said.*", "", sentence)
        for prefix, word in re.findall(r"(?<!\w)(RBD_ERR|RBD_URDF_ERR|)_([A-Z_]+)\b", sentence):
            name = (prefix or "RBD_ERR") + "_" + word
            if name in places() and name not in found:
                found.append(name)
    return found, add


@functools.lru_cache(None)
def status_list(name):
    """All statuses that a call's comment and its section's name."""
    for header in headers():
        note = ""
        for section in header.sections:
            together = 0  # calls that a sentence "Errors of these four" still covers
            shared = []
            for group in extract.groups(section):
                for item in group:
                    text = "\n".join(i.comment for i in group)
                    own, add = errors(text)
                    covers = re.search(r"Errors of these (two|three|four)", text)
                    if item is group[0] and covers:
                        together, shared = {"two": 2, "three": 3, "four": 4}[covers[1]], own
                    if item.name == name:
                        if not own and together > 0:
                            return shared
                        shared = errors(section.comment)[0] or errors(note)[0]
                        return [s for s in shared if s not in own] + own if add else own
                    together -= 1
            note = section.note or note
    return []


# ---- text of comments as Markdown ----

def escaped(text):
    return re.sub(r"([\\*_<>\[\]|$#~])", r"\\\1", text)


def linked(text, header):
    """A comment's sentence: names that the reference has are links, all else is taken as it stands."""
    out, k = [], 0
    tags = {tag: page_of(h, None) for h in (headers()[0], header) for tag in re.findall(r"^ *\[(\w+)\](?! *\[)", h.top, re.M)}
    tags |= {s.tag: page_of(header, s) for s in header.sections if s.tag}
    for match in re.finditer(r"`[^`\n]*`|\brbd(?:_\w+)?\.h\b|\b(?:rbd|RBD)_\w*[A-Za-z0-9](?:\(\))?|(?<=[ ;(])_[A-Z]+\b|\[[a-z ]+\]", text):
        word = match[0]
        out.append(escaped(text[k:match.start()]))
        name = "RBD_ERR" + word if word.startswith("_") else word.rstrip("()")
        if re.fullmatch(r"rbd\w*\.h", word):
            page = "reference/" + word[:-2]
            out.append(f"[{word}](/{page}.md)" if word in extract.HEADERS and word != header.name else word.replace("_", "\\_"))
        elif word.startswith("["):
            page = tags.get(word[1:-1])
            out.append(f"[{word[1:-1]}](/{page}.md)" if page else f"[{word[1:-1]}]".replace("[", "\\[").replace("]", "\\]"))
        elif name in places():
            out.append(f"{{c:{places()[name][1]}}}`{word} <{name}>`" if word != name else f"{{c:{places()[name][1]}}}`{name}`")
        else:
            out.append(word if word.startswith("`") else f"`{word}`")
        k = match.end()
    return "".join(out) + escaped(text[k:])


def paragraphs(comment):
    """A comment's parts: ("text", sentence), ("code", lines) and ("entry", name, text)."""
    found, last = [], None
    for line in comment.split("\n"):
        entry = re.match(r"( *)([A-Za-z_]\w*(?:\([a-z]\)| [A-Z]\w*\([a-z]\))?(?:, ?[A-Za-z_]\w*)*) {2,}(\S.*)$", line)
        indent = len(line) - len(line.lstrip())
        if not line.strip():
            last = None if not (last and last[0] == "code") else last
            if last:
                last[1] += "\n"
        elif entry and (not last or last[0] != "code") and len(entry[1]) < 4 and not line.strip().startswith("("):
            last = ["entry", entry[2], entry[3]]
            found.append(last)
        elif last and last[0] == "entry" and indent >= 2:
            last[2] += " " + line.strip()
        elif indent >= 4:
            if not last or last[0] != "code":
                last = ["code", ""]
                found.append(last)
            last[1] += line + "\n"
        else:
            if not last or last[0] != "text":
                last = ["text", ""]
                found.append(last)
            last[1] += " " + line.strip()
    return found


def fence(text, language="c"):
    lines = text.strip("\n").split("\n")
    indent = min((len(line) - len(line.lstrip()) for line in lines if line.strip()), default=0)
    return f"```{language}\n" + "\n".join(line[indent:] for line in lines) + "\n```\n"


def rendered(comment, header, leave=()):
    """A comment as Markdown; entries named in leave are left out."""
    out, rows = [], []
    for part in paragraphs(comment) + [None]:
        if part and part[0] == "entry":
            if not set(part[1].split(", ")) & set(leave):
                rows.append(part[1:])
            continue
        if rows:
            out += ["| | |", "|---|---|"] + [f"| `{n}` | {linked(t, header)} |" for n, t in rows] + [""]
            rows = []
        if part and part[0] == "text":
            out.append(linked(part[1].strip(), header) + "\n")
        elif part:
            out.append(fence(part[1]))
    return "\n".join(out)


# ---- entries ----

def together(signatures):
    """Signatures of one entry, on the directive's line: conf.py takes them apart, and each has its anchor."""
    return " ; ".join(signatures)


def signature(item):
    text = re.sub(r"/\*.*?\*/", " ", item.text, flags=re.S).split("{")[0]
    text = re.sub(r"\b(RBDI_API|RBDI_BATCH_API|RBDI_INLINE|RBDI_PART|static|RBDI_UNUSED|RBDI_AT)\b", "", text)
    return " ".join(text.split()).rstrip(";").strip()


def parameters(item):
    """Type and name of a function's parameters."""
    inside = signature(item)
    inside = inside[inside.index("(") + 1:inside.rindex(")")]
    found = []
    for word in [] if inside.strip() == "void" else inside.split(","):
        name = re.search(r"(\w+)(\[\d*\])?$", word.strip())
        found.append((word.strip()[:name.start()].strip() + (" *" if name[2] else ""), name[1], name[2] or ""))
    return found


def own_words(comment):
    """Names that a comment describes by lines of their own."""
    return {name: part[2] for part in paragraphs(comment) if part[0] == "entry" for name in part[1].split(", ")}


def argument_rows(group, header):
    """Rows of the table of arguments, and the arguments of which nothing is known."""
    rows, unknown, seen, used = [], [], set(), set()
    own = own_words("\n".join(i.comment for i in group))
    for item in group:
        for kind, name, length in parameters(item):
            base = re.sub(r"\bconst\b|\*", "", kind).strip()
            if base in HANDLES and "**" not in kind:
                continue
            spatial = header.name == "rbd_spatial.h"  # its letters are not those of the dynamics
            known, row = argument(item.name, name, own.get(name)) if not spatial else (None, None)
            used.add(row)
            if (name, known) in seen:
                continue
            seen.add((name, known))
            if spatial and name not in own:
                continue
            if not known and not own.get(name) and base not in places():
                unknown.append((item.name, name))
            shape, text = known or ("-", own.get(name) or "")
            shape = length.strip("[]") or shape if shape == "-" else shape
            shape = "-" if "**" in kind else shape  # of the pointer that is set
            way = "out" if "**" in kind or "*" in kind and not kind.startswith("const") else "in"
            way = "in, out" if re.match(r"(nv flags|in: )", text) and way == "out" else way
            rows.append((name, way, shape.replace("-", "").replace(" ", " × "), text))
    return rows, unknown, used


def cost_lines(group):
    names = [i.name for i in group]
    rows = [(a, costs()[a]) for a, call in COSTS.items() if call in names and a in costs()]
    if not rows:
        return []
    out = ["| instructions per call | iiwa | HyQ | Atlas |", "|---|--:|--:|--:|"]
    for algorithm, row in rows:
        cells = [f"{row[r]:,}" if r in row else "–" for r in ("iiwa", "hyq", "atlas")]
        name = f"`{COSTS[algorithm]}`" + (f", {COST_NOTES[algorithm]}" if algorithm in COST_NOTES else "")
        out.append(f"| {name} | " + " | ".join(cells) + " |")
    return out + [""]


def type_lines(item, header, with_text):
    kind = "enum" if item.text.startswith("typedef enum") else "struct" if "struct" in item.text else "type"
    name = item.name if kind != "type" else signature(item).replace("typedef ", "").split("__attr")[0].strip()
    out = [f"`````{{c:{kind}}} {name}\n"]
    if with_text:
        out.append(rendered(item.comment or summaries().get(item.name, ""), header))
    for declaration, text in item.members:
        names, _, value = (part.strip() for part in declaration.partition("="))
        role = "enumerator" if kind == "enum" else "member"
        words = (f"`{value}`. " if value else "") + linked(text, header) if text or value else ""
        out += [f"````{{c:{role}}} {each}\n{words}\n````\n" for each in (members_apart(names) if role == "member" else [names])]
    return out + ["`````\n"]


def macro_lines(macros, text, header):
    return ["`````{c:macro} " + together(i.text for i in macros) + "\n", rendered(text, header),
            source(macros[0], header) + "\n`````\n"]


def function_lines(functions, comment, header):
    """Results, arguments, errors, cost and examples of functions with one comment."""
    rows, _, _ = argument_rows(functions, header)
    short = "; ".join(dict.fromkeys(summaries().get(i.name, "") for i in functions))
    out = ["`````{c:function} " + together(signature(i) for i in functions) + "\n",
           rendered(comment, header, leave=[r[0] for r in rows]) or short[:1].upper() + short[1:] + ".\n"]
    out += ["```{math}\n" + formulas()[i.name] + "\n```\n" for i in functions if i.name in formulas()]
    if rows:
        out += ["| argument | | shape | meaning |", "|---|---|---|---|"]
        out += [f"| `{n}` | {way} | {shape} | {linked(text, header)} |" for n, way, shape, text in rows] + [""]
    found = dict.fromkeys(s for i in functions for s in status_list(i.name) if re.match("rbd(_urdf|_mjcf)?_status ", signature(i)))
    if found:
        out.append("**Errors** " + ", ".join(f"{{c:enumerator}}`{s}`" for s in found) + "\n")
    out += cost_lines(functions)
    examples = dict.fromkeys(s for s in (snippet(i.name) for i in functions) if s)
    return out + [fence(code) for _, code in examples]


def entry(group, header):
    """A group of declarations as one entry."""
    types, macros, functions = ([i for i in group if i.kind == kind] for kind in ("type", "macro", "function"))
    macros = [i for i in macros if i.name not in extract.named_in_top(header)]
    comment = "\n".join(i.comment for i in group if i.comment)
    if len(functions) > 1 and all(i.comment for i in group):  # each has a line of its own
        comment = "\n".join(f"{i.name}  {i.comment}" for i in group)
    out = [line for item in types for line in type_lines(item, header, with_text=not functions)]
    if macros:
        out += macro_lines(macros, comment or summaries().get(group[0].name, ""), header)
    if functions:
        out += function_lines(functions, comment, header) + [source(group[0], header) + "\n`````\n"]
    return "\n".join(out)


def members_apart(names):
    """'double lower, upper' as 'double lower' and 'double upper'."""
    match = re.match(r"((?:const )?\w+(?: const)?(?: \w+(?= [*\w]))?(?: \*const \*?)?) ?(.*)$", names)
    return [f"{match[1]} {part.strip()}" for part in match[2].split(",")] if match and "," in names else [names]


def source(item, header):
    left_out = [g.split()[1] for g in item.guards if g.startswith("ifndef RBD_NO")]
    words = f"{raw_link(f'{header.name}', item.line)}"
    return words + (f"; left out by {', '.join(f'{{c:macro}}`{g}`' for g in left_out)}" if left_out else "") + "\n"


def raw_link(path, line):
    """A link from a page of the reference to a line of a file."""
    return f'<a class="source" href="../files/{path}.html#L{line}">{path}, line {line}</a>'


def top_part(body):
    """A part of a first comment: its sentences, as lines, and its rows (name, text)."""
    sentences, rows, last = [], [], None
    for line in body.split("\n"):
        pair = re.match(r" *(\S.*?) {2,}(\S.*)$", line) or re.match(r" +(RBD_REPRODUCIBLE) (.*)$", line)
        if pair and len(line) - len(line.lstrip()) <= 4:
            last = [pair[1], pair[2]]
            rows.append(last)
        elif last and line.startswith("      "):
            last[1] += ("\n" if re.match(r" {14,}#", line) else " ") + line.strip()
        else:
            last = None
            sentences.append(line[2:] if line.startswith("  ") else line)
    return sentences, rows


def top_macro(name, text, header):
    names = re.findall(r"RBD_\w+(?:\(\w\))?", name) if "(" in name else [name.split()[0]]
    code, sentence = re.findall(r"\n(#.*)", text), re.sub(r"\n#[^\n]*", "", text)
    return ["`````{c:macro} " + together(names) + "\n\n" + linked(sentence, header) + "\n",
            (fence("\n".join(code)) if code else "") + "`````\n"]


def top_table(rows, header):
    """Rows of one text, and apart those of two: joint, q, v."""
    out = []
    for wide in (False, True):
        some = [[n, *re.split(r" {2,}", t)] for n, t in rows if bool(re.search(r"\S {2,}\S", t)) == wide]
        if some:
            out += ["| " * (3 + wide), "|---" * (2 + wide) + "|"]
            out += ["| " + " | ".join(linked(cell, header) for cell in row) + " |" for row in some] + [""]
    return out


def top_page(header):
    """The first comment: what the header is for, and its sections."""
    text = re.sub(r"^CONTENTS.*?(?:\n\n|\Z)", "", header.top, flags=re.S | re.M)
    text = re.sub(r"^[^\n]*\n(?: *Made by[^\n]*\n)?(?: *SPDX[^\n]*\n)?", "", text)
    parts = re.split(r"^ *\[(\w+)\](?! *\[)(.*)$", text, flags=re.M)
    out = [rendered(parts[0].strip("\n"), header)]
    for tag, head, body in zip(parts[1::3], parts[2::3], parts[3::3]):
        sentences, rows = top_part(body)
        lead = "\n".join(sentences).strip("\n") if not rows else "\n".join([head.strip(), *sentences]).strip("\n")
        out.append(f"\n### {tag.capitalize()}\n")
        if head.strip() and not rows:
            out.append(linked(head.strip(), header) + "\n")
        if lead:
            out.append(rendered(lead, header))
        for name, words in rows:
            out += top_macro(name, words, header) if name.startswith("RBD_") else []
        out += top_table([r for r in rows if not r[0].startswith("RBD_")], header)
    for name in sorted(set(re.findall(r"#define (RBD_\w+)", header.top)) - set(extract.named_in_top(header))):
        if owner(name) == header.name:
            out.append(f"`````{{c:macro}} {name}\n\n{escaped(summaries().get(name, ''))}\n`````\n")
    return "\n".join(out)


def owner(name):
    """The header in whose first comment this macro is explained."""
    return {"RBD_IMPLEMENTATION": "rbd.h", "RBD_URDF_IMPLEMENTATION": "rbd_urdf.h", "RBD_MJCF_IMPLEMENTATION": "rbd_mjcf.h",
            "RBD_CHECK_FRAMES": "rbd_spatial.h"}.get(name, "rbd.h" if name in extract.named_in_top(headers()[0]) else None)


def reference():
    """Pages of the reference: name and text."""
    pages, done = {}, set()
    for header in headers():
        title = re.match(r"\S+ - ([^.]*)", header.top)[1]
        page = page_of(header, None)
        text = pages.setdefault(page, [f"# {header.name}\n\n{escaped(title[0].upper() + title[1:])}.\n", top_page(header)])
        done |= set(extract.named_in_top(header)) | {n for n in re.findall(r"#define (RBD_\w+)", header.top) if owner(n) == header.name}
        for section in header.sections:
            where = pages.setdefault(page_of(header, section), [])
            if section.tag:
                level = "#" if where is not text else "##"
                where.append(f"{level} {section.title[0].upper() + section.title[1:]}\n")
                where.append(rendered(section.comment, header))
            for group in extract.groups(section):
                fresh = [i for i in group if i.name not in done]
                done |= {i.name for i in group}
                if fresh:
                    where.append(entry(fresh, header))
            if section.note:
                where.append(rendered(section.note, header))
    return {page: with_contents("\n".join(parts), page) for page, parts in pages.items()}


def with_contents(text, page):
    """The page with the names of its calls, each with its short line, behind its title."""
    here = [(name, kind) for name, (where, kind) in places().items() if where == page]
    shown = [entry for entry in here if entry[1] == "func"]
    shown = shown if len(shown) > 2 else [entry for entry in here if entry[1] != "macro"]
    if len(shown) < 3:
        return text
    rows = [f"| {{c:{kind}}}`{name}` | {summaries().get(name, '')} |" for name, kind in shown]
    rows = [re.sub(r"\]\((\w+)\.md\)", r"](/guides/\1.md)", row) for row in rows]
    end = re.search(r"^# .*\n", text, re.M).end()
    return text[:end] + "\n" + "\n".join(["| name | |", "|---|---|", *rows]) + "\n" + text[end:]


# ---- guides ----

def guides():
    return [path for _, paths in GUIDES for path in paths if (ROOT / path).exists()]


def page_name(path):
    """README.md of a folder is called by the folder."""
    name = re.sub(r"(^|/)README$", lambda m: "" if m[1] else "readme", path[:-3])
    return "guides/" + name.replace("docs/", "").replace("/", "_")


def guide(path, files):
    """A guide with its links to pages of the site and to files; files collects the latter."""
    text, here = (ROOT / path).read_text(), pathlib.PurePosixPath(path).parent

    def link(match):
        label, target = match[1], match[2]
        if target is None:  # code
            return named(match[0])
        if re.match(r"\w+:|#", target):
            return match[0]
        bare, _, anchor = target.partition("#")
        goal = os.path.normpath(str(here / bare)).replace(os.sep, "/")
        if (ROOT / goal).is_dir():
            goal = f"{goal}/README.md" if (ROOT / goal / "README.md").exists() else goal
        if not (ROOT / goal).exists():
            raise SystemExit(f"{path}: there is no {target}")
        files.add(goal)
        if match[0].startswith("!"):
            return f"![{label}](/files/{goal})"
        if goal == "docs/interface.md":  # the site has these names as pages
            return f"[{label}](../reference/names.md)"
        if goal in guides():
            return f"[{label}]({page_name(goal).split('/')[1]}.md" + (f"#{anchor}" if anchor else "") + ")"
        return f'<a href="../files/{goal}{"" if goal.endswith((".png", ".svg")) or (ROOT / goal).is_dir() else ".html"}">' + label + "</a>"

    if path in TITLES:
        text = re.sub(r"^# .*$", f"# {TITLES[path]}", text, count=1, flags=re.M)
    text = re.sub(r"^```.*?^```|!?\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s]+)\)|^#[^\n]*|`[^`\n]+`|^(?: {4}\S[^\n]*\n)+", link, text,
                  flags=re.S | re.M)
    text = re.sub(r"^```(\w+) \w+$", r"```\1", text, flags=re.M)  # names of output, for tests
    return text


def named(code):
    """`rbd_aba` or `rbd_aba()` as a link to its entry; other code as it stands."""
    name = re.fullmatch(r"`((?:rbd|RBD)_\w+)(?:\(\))?`", code)
    return f"{{c:{places()[name[1]][1]}}}{code[:-1]} <{name[1]}>`" if name and name[1] in places() else code


def title_of(path):
    return TITLES.get(path) or re.search(r"^# (.*)$", (ROOT / path).read_text(), re.M)[1]


def numbers():
    """Three numbers with what they are of, from the documents that the measurements write."""
    readme = (ROOT / "README.md").read_text()
    time = re.search(r"^\| inverse dynamics \| ([\d.]+) / .*? \| .*? \| ([\d.]+) / ", readme, re.M)
    flash = re.search(r"^\| cortex-m4f \| ([\d,]+) \|", (ROOT / "docs/firmware.md").read_text(), re.M)
    error = re.search(r"was ([\d.e-]+) in inverse dynamics", (ROOT / "docs/performance.md").read_text())
    nanoseconds, times = float(time[1]), float(time[2])
    return [(f"{nanoseconds / 1000:.2f} µs", f"inverse dynamics of an arm with seven joints on one core, {times:.1f} times as fast as Pinocchio"),
            (f"{int(flash[1].replace(',', '')) / 1000:.1f} kB", "of flash for the same on a Cortex-M4F: the whole program with the robot, without a heap"),
            (error[1], "the largest relative error of dynamics in double, against quad precision")]


def quick_start():
    """The README's first program and what it prints; a test runs it."""
    readme = (ROOT / "README.md").read_text()
    return [re.search(rf"^```{kind}\n.*?^```$", readme, re.S | re.M)[0] for kind in ("c", "text")]


def doors():
    out = ['<div class="doors">']
    for title, words, paths in DOORS:
        links = " · ".join(f'<a href="{page_name(p)}.html">{html.escape(title_of(p))}</a>' for p in paths if (ROOT / p).exists())
        out.append(f"<div><b>{title}</b><p>{words}</p><p>{links}</p></div>")
    return out + ["</div>", ""]


def index():
    """The first page: what this is in one sentence, the playground, a program, three numbers, four doors."""
    playground = os.environ.get("RBD_PLAYGROUND") == "yes"
    out = ["---", "hide-toc: true", "---", "", "# rbd", ""]
    out += ['<p class="landing">Torques, accelerations, contacts and inverse kinematics of any robot, computed by C headers that '
            "run unchanged on a PC and on a microcontroller.</p>", ""]
    picture = '<img src="files/docs/playground.png" alt="A robot in the browser with its joints, torques and mass matrix">'
    if playground:
        out += [f'<a class="look" id="playground" href="playground/index.html">{picture}<b>Open the playground: your URDF, in this browser</b></a>', ""]
    code, printed = quick_start()
    out += ["The torques that hold an arm still, in N m. As `hold.c` in the folder of `rbd.h`:", "", code, "",
            "    cc -std=c99 -O2 hold.c -lm && ./a.out", "", printed, ""]
    out += ["**Get it:** copy the headers that you use beside your program: [Install](guides/install.md) has the lines for each build "
            "system. In Python `pip install ./python`: [rbd from Python](guides/python.md).", ""]
    out += ['<div class="three">' + "".join(f"<div><b>{n}</b><span>{html.escape(what)}</span></div>" for n, what in numbers()) + "</div>", ""]
    out += doors()
    out += ["It allocates nothing, links nothing but libm, and takes a robot from a URDF file or from a table of your own. "
            "[First five minutes](guides/first_minutes.md) goes from a clone to torques; "
            "[Which call do I need?](guides/which_call.md) leads from a question to a function.", ""]
    first = ROOT / "docs/overview.svg"
    out += ["![A description is built into a constant model; the algorithms take it with the state and the caller's work "
            "memory](/files/docs/overview.svg)", ""] if first.exists() else []
    for title, paths in GUIDES:
        out += ["```{toctree}", f":caption: {title}", ":maxdepth: 1", ":hidden:", ""]
        out += ["Playground <playground>"] if playground and title == "Begin" else []
        out += [page_name(p) for p in paths if (ROOT / p).exists() and p not in HIDDEN] + ["```", ""]
    out += ["```{toctree}", ":caption: Python", ":maxdepth: 1", ":hidden:", "", *python_pages(), "```", ""]
    out += ["```{toctree}", ":caption: Reference", ":maxdepth: 1", ":hidden:", "", "reference/names", *reference(), "```", ""]
    return "\n".join(out)


@functools.lru_cache(None)
def python_pages():
    """Pages of Python's reference: name and text."""
    import python_reference  # needs numpy, which pages.py --check does without
    return python_reference.pages(lambda text: linked(text, headers()[0]))


def names_page():
    """All names, with the short line of docs/interface.md."""
    out = ["# All names\n", "| name | |", "|---|---|"]
    for name, (_, kind) in sorted(places().items(), key=lambda x: x[0].lower()):
        out.append(f"| {{c:{kind}}}`{name}` | {summaries().get(name, '')} |")
    return re.sub(r"\]\((\w+)\.md\)", r"](/guides/\1.md)", "\n".join(out)) + "\n"


# ---- files that the pages link to ----

STYLE = ("<meta name=viewport content='width=device-width'><style>:root { color-scheme: light dark } a { color: gray; text-decoration: none } "
         "@media (prefers-color-scheme: dark) { body { background: #131416; color: #ccc } }</style>")


def coloured(path, text):
    """The page of a source file, dark where the reader prefers it."""
    from pygments import highlight
    from pygments.formatters import HtmlFormatter
    from pygments.lexers import get_lexer_for_filename
    formatter = HtmlFormatter(full=True, title=path, linenos="inline", lineanchors="L", anchorlinenos=True)
    dark = HtmlFormatter(style="native").get_style_defs(".highlight")
    page = highlight(text, get_lexer_for_filename(path, stripnl=False), formatter)
    page = re.sub(r'(name|id|href)="(#?)L-(\d+)"', r'\1="\2L\3"', page)
    return page.replace("</head>", f"<style>@media (prefers-color-scheme: dark) {{ {dark} }}</style>{STYLE}</head>")


def plain(path, text):
    """The same without colours."""
    return ("<!doctype html><meta charset=utf-8><title>" + html.escape(path) + "</title>" + STYLE + "<pre>" + "\n".join(
        f'<a id="L{k}"></a>{html.escape(line)}' for k, line in enumerate(text.split("\n"), 1)) + "</pre>")


def write_file(path, folder):
    """A copy of a file, or a page with its text and its lines as anchors. With RBD_COLOURS=no in the environment long
    ones are without colours, which take five seconds."""
    whole = folder / "files" / path
    whole.parent.mkdir(parents=True, exist_ok=True)
    data = (ROOT / path).read_bytes()
    if path.endswith((".png", ".svg")):
        whole.write_bytes(data)
        return
    text = data.decode(errors="replace")
    try:
        quick = os.environ.get("RBD_COLOURS") == "no" and len(text) > 10000
        page = plain(path, text) if quick else coloured(path, text)
    except Exception:  # no lexer for such a file
        page = plain(path, text)
    (whole.parent / (whole.name + ".html")).write_text(page)


def write(folder):
    """The pages for Sphinx in folder/, and in folder/extra/ what is copied as it is."""
    files = {h.name for h in headers()} | {"docs/overview.svg"}
    files.add("docs/playground.png")
    pages = {**reference(), **python_pages(), "reference/names": names_page(), "index": index()}
    if os.environ.get("RBD_PLAYGROUND") == "yes":
        pages["playground"] = "# Playground\n"  # of the menu; theme.py leads it to the playground itself
    for path in guides():
        pages[page_name(path)] = ("---\norphan: true\n---\n" if path in HIDDEN else "") + guide(path, files)
    for name, text in pages.items():
        path = folder / (name + ".md")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    for path in files:
        if (ROOT / path).is_file():
            write_file(path, folder / "extra")
        if path.endswith((".png", ".svg")):
            (folder / "files" / path).parent.mkdir(parents=True, exist_ok=True)
            (folder / "files" / path).write_bytes((ROOT / path).read_bytes())
        elif (ROOT / path).is_dir():
            listing = "".join(f"<li>{html.escape(p.name)}</li>" for p in sorted((ROOT / path).iterdir()))
            (folder / "extra/files" / path).mkdir(parents=True, exist_ok=True)
            (folder / "extra/files" / path / "index.html").write_text(f"<!doctype html><title>{path}</title><ul>{listing}</ul>")
    (folder / "conf.py").write_text((HERE / "conf.py").read_text())
    return len(pages)


# ---- what is missing, or names what is not there ----

def problems():
    sys.path.insert(0, str(ROOT / "tests"))
    import interface
    pages = reference()
    text = "\n".join(pages.values())
    declared = set().union(*map(interface.public, interface.HEADERS))
    shown = set()
    for block in re.findall(r"^`{4,5}\{c:\w+\} ([^`]*?)\n\n|^````\{c:enumerator\} (\w+)", text, re.M):
        for line in re.split(r" ; |\n", block[0] or block[1]):
            names = re.findall(r"\b(?:rbd|RBD)_\w+(?=\(|$| *\*?$|\[)", line.strip())
            shown |= set(names[:1]) if "(" in line else set(names[-1:])
    for name in sorted(declared - shown):
        yield f"{name} has no page"
    for name in sorted(shown - declared):
        yield f"the pages have {name}, which no header declares"
    for name in formulas():
        if name not in declared:
            yield f"formulas.txt has {name}, which no header declares"
    functions = [(i, h) for h in headers() for s in h.sections for i in s.items if i.kind == "function"]
    used = set()
    for header in headers():
        for section in header.sections:
            for group in extract.groups(section):
                found = [i for i in group if i.kind == "function"]
                if found:
                    _, unknown, rows = argument_rows(found, header)
                    used |= rows
                    yield from (f"{call}: nothing is known of its argument {name}" for call, name in unknown)
    yield from (f"arguments.txt has {' '.join(key)}, which no call uses" for key in sorted(set(arguments()) - used))
    for name in snippets():
        if name not in {i.name for i, _ in functions}:
            yield f"the snippet {name} is of no function"
    for item, header in functions:
        if not snippet(item.name):
            yield f"{item.name} is in no snippet"
        if signature(item).startswith("rbd_status ") and "batch" not in item.name and not status_list(item.name):
            yield f"{item.name}: no errors are known"
    yield from (f"instructions.csv has {a}, which is of no call" for a in sorted(set(costs()) - set(COSTS)))
    yield from (f"{call} has a cost and is no function" for call in COSTS.values() if call not in declared)
    for path in guides():
        guide(path, set())  # ends with the link that leads nowhere
    listed = {p for _, paths in GUIDES for p in paths} | {"docs/interface.md"}  # whose rows are pages of the reference
    for path in sorted(p.relative_to(ROOT).as_posix() for p in (ROOT / "docs").glob("*.md")):
        if path not in listed:
            yield f"{path} is in no part of GUIDES"


def main_of(family):
    """A program that calls the snippets of a family in their order; each leaves RBD_OK in status."""
    names = ["example_" + name for name, (path, _) in snippets().items() if path.stem == family]
    calls = "".join(f'    {name}();\n    if (status != 0) printf("{name}: status %d\\n", status), bad = 1;\n    status = 0;\n'
                    for name in names)
    return ('#include <stdio.h>\n#include "rbd.h"\n#define HYQ_MODEL_IMPLEMENTATION\n#include "models/hyq_model.h"\n'
            '#define IIWA_MODEL_IMPLEMENTATION\n#include "models/iiwa_model.h"\n'
            "extern rbd_status status;\n" + "".join(f"void {name}(void);\n" for name in names) +
            f"int main(void) {{\n    int bad = {int(not names)};\n{calls}    return bad;\n}}")


def main():
    if sys.argv[1:] == ["--check"]:
        found = list(problems())
        print("\n".join(found))
        print(f"{len(places())} names, {len(snippets())} snippets, {len(found)} problems")
        return bool(found) or len(places()) < 200
    if sys.argv[1:2] == ["--main"]:
        print(main_of(sys.argv[2]))
        return 0
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    print(write(pathlib.Path(sys.argv[1])), "pages")
    return 0


if __name__ == "__main__":
    sys.exit(main())
