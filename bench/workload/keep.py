#!/usr/bin/env python3
"""Keeps a report: keep.py FOLDER NAME copies its CSV files and its page, without pictures, to bench/results/NAME.

The pictures are in FOLDER, which ./run report wrote; what they show stands in the page's sentences and tables.
SPDX-License-Identifier: MIT"""
import re
import shutil
import sys
from pathlib import Path

RESULTS = Path(__file__).resolve().parents[1] / "results"


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    source, target = Path(sys.argv[1]), RESULTS / sys.argv[2]
    page = next((path for path in sorted(source.glob("*.md"))), None)
    if page is None:
        sys.exit(f"keep.py: {source} has no report.md: ./run report writes it")
    target.mkdir(exist_ok=True)
    for path in source.glob("*.csv"):
        shutil.copyfile(path, target / path.name)
    text = page.read_text(encoding="utf-8")
    (target / page.name).write_text(re.sub(r"^!\[.*\n\n?", "", text, flags=re.M), encoding="utf-8")


if __name__ == "__main__":
    main()
