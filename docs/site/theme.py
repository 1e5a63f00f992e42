"""Makes Debian's furo work from any place: theme.py FOLDER, after Sphinx has built the site there.

Its style sheet asks a server for /javascript/normalize.css, and its Sass compiler has lost the colours of those who prefer
dark; its script imports another one, which a page from file:// must not. SPDX-License-Identifier: MIT"""
import pathlib
import re
import sys

NORMALIZE = pathlib.Path("/usr/share/javascript/normalize.css/normalize.css")


def styles(text):
    """The style sheet in one file, dark where the reader prefers it and has not chosen light."""
    text = re.sub(r"@import url\(/javascript/normalize\.css/[^)]*\);", lambda m: NORMALIZE.read_text(), text)
    if "prefers-color-scheme" not in text:
        dark = re.search(r'body\[data-theme="dark"\] (\{[^{}]*--color-[^{}]*\})', text)[1]
        text += f'@media (prefers-color-scheme: dark) {{ body:not([data-theme="light"]) {dark} }}\n'
    return text


def script(folder):
    """The script with what it imports before it, which leaves its name to all."""
    text = (folder / "furo.js").read_text()
    imported = re.match(r'import Gumshoe from "\./([\w.-]+)";\n', text)
    return (folder / imported[1]).read_text() + text[imported.end():] if imported else text


def main():
    static = pathlib.Path(sys.argv[1]) / "_static"
    sheet = static / "styles/furo.css"
    sheet.write_text(styles(sheet.read_text()))
    (static / "scripts/furo.js").write_text(script(static / "scripts"))


main()
