#!/usr/bin/env python3
"""Puts a release together: archives, checksums, and a bill of materials.

usage: release.py [--draft] [--wheels FOLDER] [--site FOLDER] OUT
       release.py --check [--draft]

Writes into OUT, for the version X.Y.Z that src/api/configuration.h states:
    rbd-X.Y.Z-headers.zip   the shipped headers, models/, LICENSE: what a firmware copies
    rbd-X.Y.Z-arduino.zip   a library for the Arduino IDE, "Add .ZIP Library"
    rbd-X.Y.Z.tar.gz        all files of the commit
    rbd-X.Y.Z-site.zip      the site, if --site names its folder
    *.whl                   the wheels of the folder
    rbd-X.Y.Z.spdx.json     what is in these files, and what they contain of others (SPDX 2.3)
    SHA256SUMS
The same commit gives the same bytes. Refuses a tree with changes and a CHANGELOG.md without the version's date, but for
--draft, which takes what lies there, committed or not. SPDX-License-Identifier: MIT"""
import argparse
import datetime
import gzip
import hashlib
import json
import os
import re
import subprocess
import sys
import tempfile
import time
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
HEADERS = (ROOT / "src/headers.txt").read_text().split() + ["rbd_urdf.h", "rbd_mjcf.h"]
DEBIAN = re.compile(r"(?:/compiled/LICENSE\.|/site/licences/)(.+?)(?:\.txt)?$")  # Debian's packages of which a wheel or the site has parts
OTHERS = re.compile(r"^==== (\S+)(?: (\d\S*), (\S+)| \(.*)$", re.M)  # what the playground has parts of


def git(*command, **more):
    """What git prints; more: of its environment."""
    environment = {**os.environ, **more}
    return subprocess.run(["git", "-C", str(ROOT), *command], check=True, stdout=subprocess.PIPE, env=environment).stdout


def what_lies_here():
    """The commit; or, where there are changes, one of all files that git does not ignore, which no branch has."""
    if not git("status", "--porcelain"):
        return "HEAD"
    date = git("log", "-1", "--format=%cI").decode().strip()
    who = {f"GIT_{role}_{what}": text for role in ("AUTHOR", "COMMITTER")
           for what, text in (("NAME", "draft"), ("EMAIL", "draft"), ("DATE", date))}
    with tempfile.TemporaryDirectory() as scratch:
        index = {"GIT_INDEX_FILE": f"{scratch}/index"}
        git("read-tree", "HEAD", **index)
        git("add", "--all", **index)
        tree = git("write-tree", **index).decode().strip()
    return git("commit-tree", tree, "-p", "HEAD", "-m", "draft", **who).decode().strip()


def is_date(text):
    """Whether it is a day, as YYYY-MM-DD."""
    try:
        return bool(re.fullmatch(r"\d{4}-\d\d-\d\d", text) and datetime.date.fromisoformat(text))
    except ValueError:
        return False


def version():
    return re.search(r'#define RBD_VERSION "(.*)"', (ROOT / "src/api/configuration.h").read_text())[1]


def what_stands_in_the_way(number):
    """Sentences; none if this may be released."""
    said = re.search(rf"^## {re.escape(number)} - (.*)$", (ROOT / "CHANGELOG.md").read_text(), re.M)
    if not said:
        yield f"CHANGELOG.md has no section of {number}"
    elif not is_date(said[1]):
        yield f"CHANGELOG.md: the date of {number} is '{said[1]}'; write YYYY-MM-DD"
    if git("status", "--porcelain"):
        yield "git status: there are changes that are not committed"


class Release:
    def __init__(self, out, number):
        self.out, self.number, self.commit = out, number, what_lies_here()
        self.seconds = int(git("log", "-1", "--format=%ct"))
        self.date = time.gmtime(self.seconds)
        out.mkdir(parents=True, exist_ok=True)
        if any(out.iterdir()):
            sys.exit(f"release: {out} is not empty: what lies there would be part of the release")

    def names(self, folder):
        """The files of a folder in the commit."""
        return git("ls-tree", "-r", "--name-only", self.commit, folder).decode().split()

    def file(self, name):
        """A file of the commit."""
        return git("show", f"{self.commit}:{name}")

    def zip(self, kind, files):
        """An archive of {name in it: bytes}, in a folder of the release's name."""
        path = self.out / f"rbd-{self.number}-{kind}.zip"
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, data in sorted(files.items()):
                entry = zipfile.ZipInfo(f"rbd-{self.number}/{name}", self.date[:6])
                entry.external_attr = 0o644 << 16
                entry.compress_type = zipfile.ZIP_DEFLATED
                archive.writestr(entry, data)

    def headers(self):
        models = [name for name in self.names("models/") if name.endswith(".h")]
        self.zip("headers", {name: self.file(name) for name in [*HEADERS, *models, "LICENSE", "CHANGELOG.md"]})

    def arduino(self):
        """The include path of such a library is its src/: there stand the shipped headers."""
        files = {f"src/{name}": self.file(name) for name in HEADERS if name not in ("rbd_urdf.h", "rbd_mjcf.h")}
        others = ["library.properties", "LICENSE", "README.md", "CHANGELOG.md", *self.names("examples/arduino_gravity/")]
        files.update({name: self.file(name) for name in others})
        self.zip("arduino", files)

    def source(self):
        tree = git("archive", "--format=tar", f"--prefix=rbd-{self.number}/", self.commit)
        (self.out / f"rbd-{self.number}.tar.gz").write_bytes(gzip.compress(tree, mtime=self.seconds))

    def site(self, folder):
        if not (folder / "index.html").is_file():
            sys.exit(f"release: {folder} has no index.html: ./run site makes it")
        self.zip("site", {f"site/{path.relative_to(folder)}": path.read_bytes() for path in folder.rglob("*") if path.is_file()})

    def wheels(self, folder):
        found = sorted(folder.glob(f"rbd-{self.number}-*.whl"))
        if not found:
            sys.exit(f"release: {folder} has no wheel of {self.number}: ./run wheel makes it")
        for path in found:
            if any(zipfile.ZipFile(path).read(f"rbd/sources/{name}") != self.file(name) for name in HEADERS):
                sys.exit(f"release: {path.name} has other headers than this commit: ./run wheel makes it anew")
            (self.out / path.name).write_bytes(path.read_bytes())

    def files(self):
        return sorted(path for path in self.out.iterdir() if path.suffix in (".zip", ".gz", ".whl"))

    def materials(self):
        """SPDX: a package for each file, and one for each work of others of which a wheel or the site has parts."""
        packages, relations = [], []
        for number, path in enumerate(self.files()):
            name = f"SPDXRef-file-{number}"
            others = brought(path)
            packages.append(package(name, path.name, self.number, "MIT", hashlib.sha256(path.read_bytes()).hexdigest()))
            packages[-1]["licenseConcluded"] = "NOASSERTION" if others else "MIT"  # these have licences of their own
            relations.append(("SPDXRef-DOCUMENT", "DESCRIBES", name))
            for other, *rest in others:
                place = f"SPDXRef-other-{re.sub('[^a-zA-Z0-9.-]', '-', other)}"
                if place not in [p["SPDXID"] for p in packages]:
                    packages.append(package(place, other, *rest))
                relations.append((name, "CONTAINS", place))
        document = {
            "spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT", "name": f"rbd-{self.number}",
            "documentNamespace": f"urn:rbd:{self.number}:{git('rev-parse', self.commit).decode().strip()}",
            "creationInfo": {"created": time.strftime("%Y-%m-%dT%H:%M:%SZ", self.date), "creators": ["Tool: packaging/release.py"]},
            "packages": packages,
            "relationships": [dict(zip(("spdxElementId", "relationshipType", "relatedSpdxElement"), r)) for r in relations]}
        (self.out / f"rbd-{self.number}.spdx.json").write_text(json.dumps(document, indent=1) + "\n")

    def checksums(self):
        files = [*self.files(), self.out / f"rbd-{self.number}.spdx.json"]
        lines = [f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}\n" for path in files]
        (self.out / "SHA256SUMS").write_text("".join(lines))


def package(place, name, number, licence, checksum=None):
    fields = {"SPDXID": place, "name": name, "versionInfo": number, "downloadLocation": "NOASSERTION", "licenseConcluded": licence,
              "licenseDeclared": licence, "copyrightText": "NOASSERTION", "filesAnalyzed": False}
    if checksum:
        fields["checksums"] = [{"algorithm": "SHA256", "checksumValue": checksum}]
    return fields


def brought(path):
    """Name, version and licence of the works of others that a wheel or the site has parts of."""
    if path.suffix not in (".whl", ".zip"):
        return []
    archive = zipfile.ZipFile(path)
    debian = sorted(found[1] for found in map(DEBIAN.search, archive.namelist()) if found)
    playground = [archive.read(name).decode() for name in archive.namelist() if name.endswith("/playground/LICENCES.txt")]
    others = [found for text in playground for found in OTHERS.findall(text) if found[0] != "rbd"]
    return [*((name, debian_version(name), "NOASSERTION") for name in debian),
            *((name, version or debian_version(name), licence or "NOASSERTION") for name, version, licence in others)]


def debian_version(name):
    said = subprocess.run(["dpkg-query", "-W", "-f", "${Version}", name], stdout=subprocess.PIPE, text=True)
    return said.stdout or "unknown"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--draft", action="store_true")
    parser.add_argument("--check", action="store_true", help="says what stands in the way, and writes nothing")
    parser.add_argument("--wheels", type=Path)
    parser.add_argument("--site", type=Path)
    parser.add_argument("out", type=Path, nargs="?")
    options = parser.parse_args()
    if not options.check and not options.out:
        parser.error("the folder to write into is missing")

    number = version()
    problems = list(what_stands_in_the_way(number))
    for problem in problems:
        print(f"release: {problem}", file=sys.stderr)
    if problems and not options.draft:
        sys.exit("release: nothing is written; --draft writes all the same")
    if options.check:
        return

    release = Release(options.out, number)
    release.headers()
    release.arduino()
    release.source()
    if options.site:
        release.site(options.site)
    if options.wheels:
        release.wheels(options.wheels)
    release.materials()
    release.checksums()
    print((release.out / "SHA256SUMS").read_text(), end="")


if __name__ == "__main__":
    main()
