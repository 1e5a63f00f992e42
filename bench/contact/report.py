#!/usr/bin/env python3
"""Steps with contacts beside MuJoCo: measures, counts, draws and writes them; ./run contact [FOLDER]

usage: report.py PROGRAMS FOLDER     PROGRAMS: the folder of `contact` and `contact-haswell`
       report.py --document [--write]    whether the table of docs/contact_step.md is that of its results
       report.py --instructions          the instructions of these results
SPDX-License-Identifier: MIT"""
import csv
import datetime
import os
import re
import shlex
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
DOCUMENT = os.path.join(ROOT, "docs", "contact_step.md")
MARK = re.compile(r"(<!-- contact of (\S+) -->\n).*?(<!-- end -->)", re.DOTALL)
sys.path.insert(0, os.path.join(ROOT, "bench", "workload"))
import callgrind  # noqa: E402
import figures  # noqa: E402

ROBOTS = ["HyQ dropped, stands", "HyQ trots", "Atlas stands"]
ROWS = {"HyQ dropped, stands": "12", "HyQ trots": "12", "Atlas stands": "24", "block, 26 degrees": "12",
        "block, 27 degrees": "12", "block, 40 degrees": "12", "thrown box": "24", "stack 1, 1, 100 kg": "36"}
# Errors of a result: scene, words, column, unit.
ERRORS = [(scene, "deepest penetration", "deepest_m", "m") for scene in ROBOTS + ["thrown box", "stack 1, 1, 100 kg"]] + [
    ("thrown box", "energy made (it has 36 J)", "energy_made_J", "J"),
    ("block, 26 degrees", "creeps below the threshold of friction", "creep_m_s", "m/s"),
    ("block, 27 degrees", "error of the acceleration", "acceleration_error", "m/s²"),
    ("block, 40 degrees", "error of the acceleration", "acceleration_error", "m/s²"),
    ("block, 40 degrees", "hovers at the end", "hover_m", "m")]
EXACT, QUICK = "rbd, 1e-8 m/s", "rbd, 1e-5 m/s"


# ---- measuring ----

def measure(programs, folder):
    raw = os.path.join(folder, "callgrind.out")
    subprocess.run(["valgrind", "--quiet", "--command-line-only=yes", "--tool=callgrind", "--collect-atstart=no",
                    "--combine-dumps=yes", "--callgrind-out-file=" + raw, os.path.join(programs, "contact-haswell"),
                    "--count"], check=True)
    counts = {}
    with open(raw, errors="replace") as lines:
        for trigger, totals, _ in callgrind.parse(lines):
            scene, setting, steps = trigger.split(";")
            counts[scene, setting] = totals["Ir"] / int(steps)
    os.remove(raw)
    text = subprocess.run([os.path.join(programs, "contact")], stdout=subprocess.PIPE, text=True, check=True).stdout
    rows = list(csv.DictReader(text.splitlines()))
    for row in rows:
        row["instructions"] = "%.0f" % counts[row["scene"], row["setting"]] if row["step_ms"] == "1" else ""
    with open(os.path.join(folder, "contact.csv"), "w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    measure_npm(programs, folder)


def measure_npm(programs, folder):
    """Results, without times, of MuJoCo's WebAssembly build, where the environment says which folder has it."""
    packages, path = os.environ.get("MUJOCO_NPM"), os.path.join(folder, "contact-npm.csv")
    if not packages:
        if os.path.exists(path):
            os.remove(path)
        return
    script = os.path.join(ROOT, "bench", "contact", "mujoco.mjs")
    with open(path, "w") as file:
        subprocess.run([os.path.join(programs, "contact"), "--results-of", "node %s %s" % (
            shlex.quote(script), shlex.quote(packages))], stdout=file, check=True)


class Results:
    def __init__(self, folder, name="contact.csv"):
        with open(os.path.join(folder, name), newline="") as file:
            self.rows = list(csv.DictReader(file))
        self.mujoco = next(r["library"] for r in self.rows if r["library"] != "rbd")

    def of(self, scene, step="1"):
        return [r for r in self.rows if r["scene"] == scene and r["step_ms"] == step]

    def row(self, scene, setting, step="1"):
        return next(r for r in self.of(scene, step) if r["setting"] == setting)

    def fastest(self, scene):
        """MuJoCo's setting of the fewest instructions, without those by which a block hops: in the air it costs nothing."""
        return min((r for r in self.of(scene) if r["library"] != "rbd" and not (
            "block" in scene and float(r["hover_m"]) > 0.01)), key=lambda r: int(r["instructions"]))["setting"]

    def most_exact(self, scene, column, step="1"):
        """MuJoCo's setting of the least error."""
        return min((r for r in self.of(scene, step) if r["library"] != "rbd"),
                   key=lambda r: (error(r, column), float(r["ns"])))["setting"]


def error(row, column):
    """An error's size; a block that sinks does not hover."""
    x = float(row[column])
    return max(x, 0) if column == "hover_m" else abs(x)


# ---- tables ----

def shortly(x):
    return "%.1e" % x if x > 0 else "0"

def table(head, rows, numbers):
    rule = ["---"] * (len(head) - numbers) + ["--:"] * numbers
    return "".join("|%s|\n" % "|".join(r) for r in [[" %s " % " | ".join(head)], rule] + [
        [" %s " % " | ".join(row)] for row in rows])


def nanoseconds(row):
    return "%.0f%s" % (float(row["ns"]), "*" if row["disturbed"] == "1" else "")


def costs(results):
    rows = []
    for scene in ROWS:
        ours, quick, other = (results.row(scene, s) for s in (EXACT, QUICK, results.fastest(scene)))
        rows.append(["%s (%s rows)" % (scene, ROWS[scene])] + [
            "%s; %s" % (r["instructions"], nanoseconds(r)) for r in (ours, quick, other)] + [other["setting"]] + [
            "%.1f; %.1f" % (int(other["instructions"]) / int(r["instructions"]), float(other["ns"]) / float(r["ns"]))
            for r in (ours, quick)])
    return table(["instructions; ns of a step of 1 ms", EXACT, QUICK, results.mujoco + " at its fastest", "its setting",
                  "ratios to 1e-8 m/s", "to 1e-5 m/s"], rows, 6)


def errors(results, step="1"):
    rows = []
    for scene, words, column, unit in ERRORS:
        exact = results.row(scene, results.most_exact(scene, column, step), step)
        cells = [results.row(scene, s, step) for s in (EXACT, QUICK, results.fastest(scene))] + [exact]
        rows.append(["%s: %s, %s" % (scene, words, unit)] + [shortly(error(r, column)) for r in cells] + [
            exact["setting"], nanoseconds(exact)])
    return table(["", EXACT, QUICK, results.mujoco + " at its fastest", "at its most exact", "that setting", "its ns"],
                 rows, 6)


def versions(results, other):
    """The errors of another MuJoCo in the same settings."""
    rows = []
    for scene, words, column, unit in ERRORS:
        setting = results.most_exact(scene, column)
        cells = [error(r.row(scene, setting), column) for r in (results, other)]
        rows.append(["%s: %s, %s" % (scene, words, unit)] + [shortly(x) for x in cells] + [setting])
    return table(["", results.mujoco, other.mujoco, "setting: the most exact of the first"], rows, 3)


def document_tables(results):
    return costs(results) + "\n" + errors(results)


# ---- figure ----

def draw(results, folder):
    bars = [(EXACT, lambda s: EXACT), (QUICK, lambda s: QUICK), (results.mujoco + ", fastest", results.fastest),
            (results.mujoco + ", most exact", lambda s: results.most_exact(s, "deepest_m"))]
    data = []  # blocks for gnuplot's index
    for _, setting in bars:
        data.append(["\"%s\" %s %s" % (s.replace(", ", "\\n"), int(results.row(s, setting(s))["instructions"]) / 1000,
                                       float(results.row(s, setting(s))["ns"]) / 1000) for s in ROBOTS])
    steps = list(dict.fromkeys(r["step_ms"] for r in results.rows))
    for scene in ("HyQ dropped, stands", "Atlas stands"):
        for _, setting in bars:
            data.append(["%s %g" % (h, max(error(results.row(scene, setting(scene), h), "deepest_m"), 1e-9)) for h in steps])
    shown = [r for r in results.of("block, 26 degrees") if "CG" not in r["setting"] and "1e-" not in r["setting"].replace(EXACT, "")]
    for ours in (True, False):
        data.append(["%g %g \"%s\"" % (int(r["instructions"]) / 1000, max(error(r, "creep_m_s"), 1e-12), r["setting"])
                     for r in shown if (r["library"] == "rbd") == ours])
    script = figures.legend([(name, figures.SHADES[i]) for i, (name, _) in enumerate(bars)], 2)
    script += "set style data histograms\nset style histogram clustered gap 1\nset boxwidth 0.9\nunset key\nset yrange [0:*]\n"
    for column, words in ((2, "thousand instructions"), (3, "microseconds")):
        script += "set title 'A step of 1 ms: %s'\nplot %s\n" % (words, ", ".join(
            "'DATA' index %d using %d:xtic(1) lc rgb '%s'" % (i, column, figures.SHADES[i]) for i in range(len(bars))))
    lines = ["#1f2d4d", "#5f86b3", "#d98b1f", "#a04020"]
    script += ("set style data linespoints\nset logscale xy\nset format y '%%.0e'\nset yrange [5e-10:100]\nset xrange [0.4:14]\n"
               "set xtics (0.5, 1, 2, 5, 10)\nset xlabel 'step, ms'\nset key top center maxrows 4 samplen 2 font ',10'\n"
               "set title 'Deepest penetration, m (1e-9: or less)'\nplot %s\n" % ", ".join(
                   "'DATA' index %d lc rgb '%s' lw 2 dt %d pt %d ps 1.3 title '%s'" % (
                       4 + 4 * k + i, lines[i], k + 1, 7 - 2 * k, "%s: %s" % (scene, bars[i][0]))
                   for k, scene in enumerate(("HyQ", "Atlas")) for i in range(4)))
    script += ("set style data points\nset xlabel 'thousand instructions'\nset xtics autofreq\nset xrange [3:400]\n"
               "set yrange [1e-13:1]\nset key top right\nset title 'Block at 26 degrees, threshold 26.6: creeps, m/s (1e-12: or less)'\n"
               "plot 'DATA' index 12 pt 7 ps 1.8 lc rgb '%s' title 'rbd', '' index 12 using 1:2:3 with labels left offset 1.2,0 "
               "font ',11' notitle, '' index 13 pt 5 ps 1.8 lc rgb '%s' title '%s', '' index 13 using 1:2:3 with labels left "
               "offset 1.2,0 font ',11' notitle\n" % (lines[0], lines[3], results.mujoco))
    figures.run_gnuplot(script, "\n\n\n".join("\n".join(block) for block in data) + "\n", folder, "contact",
                        "A step with contacts", 2, rows=2, top=6, bottom=5)
    os.remove(os.path.join(folder, "contact.svg"))


# ---- page ----

def first_line(*command):
    return subprocess.run(command, capture_output=True, text=True).stdout.splitlines()[0]


def processor():
    with open("/proc/cpuinfo") as file:
        return next((line.split(": ", 1)[1].strip() for line in file if line.startswith("model name")), "unknown")


def npm_section(results, folder):
    if not os.path.exists(os.path.join(folder, "contact-npm.csv")):
        return ""
    other = Results(folder, "contact-npm.csv")
    return "\n## Another version\n\n%s is the WebAssembly build of npm: results alone, no times.\n\n%s" % (
        other.mujoco, versions(results, other))


def page(results, folder):
    steps = list(dict.fromkeys(r["step_ms"] for r in results.rows))
    return """# A step with contacts, beside MuJoCo

`./run contact`, %s; %s; %s; load %.1f at the end. rbd: `-O3 -march=native -ffp-contract=fast`;
under valgrind, which counts the instructions, `-march=haswell`. %s as installed. [bench/README.md](../../README.md#contacts-beside-mujoco)
has the method. A star: the least time did not come twice to 3 %%.

![Costs and errors](contact.png)

## Costs

%s
## Errors with steps of 1 ms

%s%s%s""" % (datetime.date.today(), processor(), first_line("cc", "--version"), os.getloadavg()[0], results.mujoco,
           costs(results), errors(results), "".join(
               "\n## With steps of %s ms\n\n%s" % (h, errors(results, h)) for h in steps if h != "1"),
           npm_section(results, folder))


def document(write):
    with open(DOCUMENT) as file:
        text = file.read()
    new = MARK.sub(lambda m: m[1] + document_tables(Results(os.path.join(ROOT, m[2]))) + m[3], text)
    if write:
        with open(DOCUMENT, "w") as file:
            file.write(new)
    if not MARK.search(text) or (new != text and not write):
        sys.exit("docs/contact_step.md: its table is not that of the results: bench/contact/report.py --document --write")


def instructions():
    with open(DOCUMENT) as file:
        folder = MARK.search(file.read())[2]
    results = Results(os.path.join(ROOT, folder))
    for scene, rows in ROWS.items():
        print("15 %s, %s rows, 1e-8 m/s: %s instructions a step, in %s" % (
            scene, rows, results.row(scene, EXACT)["instructions"], folder))


def main(arguments):
    if arguments == ["--instructions"]:
        return instructions()
    if arguments and arguments[0] == "--document" and arguments[1:] in ([], ["--write"]):
        return document(bool(arguments[1:]))
    if len(arguments) != 2:
        sys.exit(__doc__)
    programs, folder = arguments
    os.makedirs(folder, exist_ok=True)
    measure(programs, folder)
    results = Results(folder)
    draw(results, folder)
    with open(os.path.join(folder, "contact.md"), "w") as file:
        file.write(page(results, folder))
    print(os.path.join(folder, "contact.md"))


if __name__ == "__main__":
    main(sys.argv[1:])
