#!/usr/bin/env python3
"""Draws the pictures of the guides: draw.py [--write]; without, whether they are those that it draws.

firmware.svg shows figures of bench/results/firmware.csv. SPDX-License-Identifier: MIT"""
import csv
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
HEAD = ('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {w} {h}" font-family="sans-serif" font-size="14">\n'
        '<defs><marker id="tip" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="7" markerHeight="7" orient="auto-start-reverse">'
        '<path d="M0 0L10 5L0 10z" fill="context-stroke"/></marker></defs>\n'
        '<rect width="{w}" height="{h}" rx="8" fill="#fff"/>\n')


def text(x, y, words, **how):
    extra = "".join(f' {key.replace("_", "-")}="{value}"' for key, value in how.items())
    return f'<text x="{x}" y="{y}"{extra}>{words}</text>\n'


def arrow(x, y, dx, dy, colour, words="", away=(8, 5)):
    line = f'<path d="M{x} {y}l{dx} {dy}" stroke="{colour}" stroke-width="2.5" marker-end="url(#tip)"/>\n'
    return line + (text(x + dx + away[0], y + dy + away[1], words, fill=colour) if words else "")


def floating_base():
    """The world's frame, and the base's with what q and v are."""
    out = HEAD.format(w=720, h=270)
    for k, (dx, dy, name) in enumerate([(80, 0, "x"), (-38, 34, "y"), (0, -80, "z")]):
        out += arrow(110, 200, dx, dy, ["#c02626", "#128a4a", "#1f5fd0"][k], name, [(8, 5), (-16, 12), (-4, -8)][k])
    out += text(96, 246, "world", fill="#345")
    out += '<path d="M110 200L300 125" stroke="#888" stroke-width="1.5" stroke-dasharray="6 5" marker-end="url(#tip)"/>\n'
    out += text(150, 140, "q[0..2]", fill="#555", font_weight="bold")
    out += '<g transform="translate(320 115) rotate(-18)"><rect x="-70" y="-32" width="140" height="64" rx="12" fill="#e8862e" fill-opacity="0.35" stroke="#e8862e"/></g>\n'
    for k, (dx, dy, name) in enumerate([(76, -25, "x"), (-30, 38, "y"), (-25, -76, "z")]):
        out += arrow(320, 115, dx, dy, ["#c02626", "#128a4a", "#1f5fd0"][k], name, [(8, 5), (-16, 10), (-14, -4)][k])
    out += text(285, 195, "base: turned by the quaternion q[3..6]", fill="#345")
    out += text(425, 80, "v[0..2]: turns about these axes", fill="#345") + text(425, 102, "v[3..5]: moves along them", fill="#345")
    out += text(285, 220, "tau[0..2], tau[3..5]: moment and force likewise", fill="#345")
    return out + "</svg>\n"


def firmware():
    """Flash of the whole program: three calls on three targets, float, -Os, the iiwa."""
    calls, targets = [("id_own", "inverse dynamics"), ("mm_own", "mass matrix"), ("fd_own", "forward dynamics")], ["cortex-m0", "cortex-m4f", "rv32imafc"]
    with open(ROOT / "bench/results/firmware.csv", newline="") as file:
        rows = {(r["target"], r["algorithm"]): r for r in csv.DictReader(file)
                if r["robot"] == "iiwa" and r["scalar"] == "float" and r["level"] == "s"}
    out = HEAD.format(w=720, h=292) + text(20, 28, "Flash of the whole program with the robot, float, -Os: kB", fill="#345", font_weight="bold")
    most = 24000
    for i, (call, words) in enumerate(calls):
        for k, target in enumerate(targets):
            size = int(rows[target, call]["program"])
            y, width = 48 + 80 * i + 23 * k, 380 * size / most
            out += f'<rect x="260" y="{y}" width="{width:.1f}" height="18" rx="3" fill="{["#888", "#1f5fd0", "#128a4a"][k]}"/>\n'
            out += text(252, y + 14, (words + ", " if k == 0 else "") + target, text_anchor="end", fill="#345")
            out += text(f"{268 + width:.1f}", y + 14, f"{size / 1000:.1f}", fill="#345")
    return out + "</svg>\n"


def main():
    bad = 0
    for name, picture in (("floating_base", floating_base()), ("firmware", firmware())):
        path = ROOT / f"docs/{name}.svg"
        if sys.argv[1:] == ["--write"]:
            path.write_text(picture)
        elif not path.exists() or path.read_text() != picture:
            print(f"docs/{name}.svg is not what docs/site/draw.py draws: draw.py --write")
            bad = 1
    return bad


sys.exit(main())
