"""Makes Debian's furo work from any place: theme.py FOLDER, after Sphinx has built the site there.

Its style sheet asks a server for /javascript/normalize.css, and its Sass compiler has lost the colours of those who prefer
dark; its script imports another one, which a page from file:// must not. Sphinx's search asks a server for each page: it gives
way to ours. Names of the library in blocks of code become links to their entries; the menu's line of the playground leads to
it. SPDX-License-Identifier: MIT"""
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


SEARCH = re.compile(r'<script[^>]*src="(?:_static/(?:searchtools|language_data)|searchindex)\.js"[^>]*></script>|<script>[^<]*loadIndex[^<]*</script>')


def search(page):
    """The page of results with our search in place of Sphinx's."""
    ours = "".join(f'<script src="_static/{name}"></script>' for name in ("search_index.js", "search.js"))
    text = SEARCH.sub("", page)
    text = re.sub(r"<script[^>]*>\s*</script>(?=\s*<noscript)", "", text)
    return text.replace("</body>", ours + "</body>")


def anchors(folder):
    """Name and the page with its entry."""
    found = {}
    for page in sorted((folder / "reference").glob("*.html")):
        for anchor in re.findall(r'<dt[^>]* id="(c\.[\w.]+)"', page.read_text()):
            found.setdefault(anchor.split(".")[-1], f"reference/{page.name}#{anchor}")
    return found


def linked(page, places, up):
    """The page with links from its code to the reference."""
    def link(match):
        goal = places.get(match[2])
        return f'<a class="api" href="{up}{goal}">{match[0]}</a>' if goal else match[0]
    return re.sub(r'<span class="(n|nf|nc)">((?:rbd|RBD)_\w+)</span>', link, page)


def main():
    folder = pathlib.Path(sys.argv[1])
    places = anchors(folder)
    for page in [*folder.glob("*.html"), *folder.glob("guides/*.html"), *folder.glob("reference/*.html")]:
        up = "" if page.parent == folder else "../"
        text = linked(page.read_text(), places, up)
        text = re.sub(r'href="(\.\./)?playground\.html"', lambda m: f'href="{m[1] or ""}playground/index.html"', text)
        page.write_text(search(text) if page.name == "search.html" else text)
    for name in ("playground.html", "searchindex.js"):
        (folder / name).unlink(missing_ok=True)
    static = folder / "_static"
    sheet = static / "styles/furo.css"
    sheet.write_text(styles(sheet.read_text()))
    (static / "scripts/furo.js").write_text(script(static / "scripts"))


main()
