#!/usr/bin/env python3
"""Checks the manifests of PlatformIO, Arduino, ESP-IDF and Zephyr: their form, rbd.h's version in each, that the
files they name exist, and that what they would publish suffices to compile against.
usage: manifests.py DIRECTORY_OF_RBD_H"""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

try:
    import kconfiglib
    import yaml
except ImportError as missing:
    print("needs", missing.name)
    sys.exit(77)

root = pathlib.Path(sys.argv[1])
header = (root / "rbd.h").read_text()
version = re.search(r'^#define RBD_VERSION "(\d+\.\d+\.\d+)"', header, re.M).group(1)
failures = []


def check(name, condition, message):
    if not condition:
        failures.append(f"{name}: {message}")


def check_fields(name, fields, required, optional):
    for field in sorted(required - set(fields)):
        check(name, False, f"{field} is missing")
    for field in sorted(set(fields) - required - optional):
        check(name, False, f"unknown field {field}")
    check(name, fields.get("name", "rbd") == "rbd", f"the name is {fields.get('name')}")
    if "version" in required:
        check(name, fields.get("version") == version, f"version {fields.get('version')}, rbd.h has {version}")


def check_publication(name, files):
    """A copy of these files alone is what a user gets: his program compiles."""
    with tempfile.TemporaryDirectory() as scratch:
        for file in files:
            copy = pathlib.Path(scratch, "rbd", file.relative_to(root))
            copy.parent.mkdir(parents=True, exist_ok=True)
            copy.write_bytes(file.read_bytes())
        program = pathlib.Path(scratch, "program.c")
        program.write_text('#include <rbd.h>\n#include <models/iiwa_model.h>\nconst void *m = &iiwa_model;\n')
        result = subprocess.run([*os.environ.get("CC", "cc").split(), "-std=c99", f"-I{scratch}/rbd", "-fsyntax-only",
                                 program], capture_output=True, text=True)
        check(name, result.returncode == 0, "what is published does not compile:\n" + result.stderr)
        for needed in "LICENSE", "README.md":
            check(name, pathlib.Path(scratch, "rbd", needed).exists(), f"{needed} would not be published")


def platformio():
    name = "library.json"
    fields = json.loads((root / name).read_text())
    check_fields(name, fields, {"name", "version", "description", "keywords", "authors", "license", "frameworks",
                                "platforms", "headers", "build", "export", "examples"}, {"repository", "homepage"})
    for keyword in fields["keywords"]:
        check(name, re.fullmatch(r"[a-z\d\-+. ]{1,50}", keyword), f"keyword '{keyword}'")
    headers = (root / "src/headers.txt").read_text().split()
    check(name, fields["headers"] == headers, "headers are not those of src/headers.txt")
    check(name, set(headers) <= set(fields["export"]["include"]), "a header would not be published")
    # The include path is the root, as there is neither src nor include; nothing is compiled, nothing archived.
    check(name, fields["build"] == {"srcFilter": "-<*>", "libArchive": False}, "sources would be compiled")
    files = []
    for pattern in fields["export"]["include"]:
        found = [root / pattern] if (root / pattern).is_file() else list((root / pattern).glob("*"))
        found = found or list(root.glob(pattern))
        check(name, found, f"'{pattern}' matches nothing")
        files += found
    for example in fields["examples"]:
        for file in example["files"]:
            check(name, root / example["base"] / file in files, f"example {file} is not published")
    check_publication(name, files)


def arduino():
    name = "library.properties"
    lines = (root / name).read_text().splitlines()
    fields = dict(line.split("=", 1) for line in lines)
    check(name, len(fields) == len(lines), "a field stands twice")
    check_fields(name, fields, {"name", "version", "author", "maintainer", "sentence", "paragraph", "category",
                                "architectures", "includes"}, {"url"})
    categories = {"Display", "Communication", "Signal Input/Output", "Sensors", "Device Control", "Timing",
                  "Data Storage", "Data Processing", "Other"}
    check(name, fields["category"] in categories, f"no such category: {fields['category']}")
    for header in fields["includes"].split(","):
        check(name, (root / header).is_file(), f"no {header}")
    # The include path is src/ alone, whose rbd.h includes the rooms, and sources in it would be compiled.
    for header in fields["includes"].split(","):
        check(name, (root / "src" / header).is_file(), f"no src/{header}")
    for source in [*root.glob("src/**/*.c"), *root.glob("src/**/*.cpp"), *root.glob("src/**/*.S")]:
        check(name, False, f"{source.name} in src/ would be compiled")
    for folder in "utility", "include":
        check(name, not (root / folder).exists(), f"the folder {folder} changes what is compiled")
    for sketch in root.glob("examples/**/*.ino"):
        for header in re.findall(r'#include <(\S+)>', sketch.read_text()):
            check(name, (root / "src" / header).is_file(), f"{sketch} includes {header}, which is not in src/")
    for source in [*root.glob("*.c"), *root.glob("*.cpp"), *root.glob("*.S")]:
        check(name, False, f"{source.name} in the root would be compiled")
    for sketch in root.glob("examples/**/*.ino"):
        check(name, sketch.stem == sketch.parent.name, f"{sketch} must be named as its folder")


def esp_idf():
    name = "idf_component.yml"
    fields = yaml.safe_load((root / name).read_text())
    check_fields(name, fields, {"version", "description", "license", "files"}, {"url", "repository"})
    files = {file for file in root.rglob("*") if file.is_file() and ".git" not in file.parts}
    for pattern in fields["files"]["exclude"]:
        files -= set(root.glob(pattern))
    for source in [file for file in files if file.suffix in {".c", ".cpp", ".ino", ".inc"}]:
        check(name, False, f"{source} would be published")
    check_publication(name, files)


def zephyr():
    name = "zephyr/module.yml"
    fields = yaml.safe_load((root / name).read_text())
    check_fields(name, fields, {"name", "build"}, set())
    check(name, set(fields["build"]) == {"cmake", "kconfig"}, "build has other keys")
    check(name, (root / fields["build"]["cmake"] / "CMakeLists.txt").is_file(), "cmake names no CMakeLists.txt")
    with tempfile.NamedTemporaryFile("w", suffix="Kconfig") as top:
        top.write(f'config REQUIRES_FULL_LIBC\n\tbool\n\nosource "{root / fields["build"]["kconfig"]}"\n')
        top.flush()
        options = kconfiglib.Kconfig(top.name)
    check(name, not options.warnings, f"Kconfig: {options.warnings}")
    check(name, options.syms["RBD"].str_value == "n", "rbd is there without CONFIG_RBD")
    options.syms["RBD"].set_value("y")
    check(name, options.syms["REQUIRES_FULL_LIBC"].str_value == "y", "CONFIG_RBD has no sin and cos")


for manifest in platformio, arduino, esp_idf, zephyr:
    manifest()
print("\n".join(failures) or f"library.json, library.properties, idf_component.yml, zephyr/: version {version}")
sys.exit(1 if failures else 0)
