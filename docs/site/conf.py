# Sphinx's configuration of the site; docs/site/build.sh calls it. Formulas are set by KaTeX, from the site itself.
import os
import pathlib
import re

ROOT = pathlib.Path(os.environ["RBD_ROOT"])
project = "rbd"
version = release = re.search(r'#define RBD_VERSION "(.*)"', (ROOT / "rbd.h").read_text())[1]
copyright = re.search(r"Copyright \(c\) (.*)", (ROOT / "LICENSE").read_text())[1]
html_title = f"rbd {version}"
extensions = ["myst_parser", "sphinx.ext.mathjax"]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
myst_dmath_allow_digits = False
html_theme = "furo"
primary_domain = "c"
highlight_language = "text"
smartquotes = False
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = True
html_extra_path = ["extra"]
exclude_patterns = ["extra"]
html_static_path = ["static"]
html_css_files = ["katex/katex.min.css", "site.css"]
mathjax_path = "katex/katex.min.js"
mathjax_options = {"defer": "defer"}
html_js_files = ["math.js", "site.js"]
html_use_index = False
suppress_warnings = ["myst.header", "misc.highlighting_failure"]
nitpicky = False


def setup(app):
    """Several declarations with one comment are one entry, and each has its anchor: pages.py writes them with ; between."""
    from sphinx.domains.c import CFunctionObject, CMacroObject

    def get_signatures(directive):
        return [part.strip() for part in directive.arguments[0].split(";")]

    for name, base in (("function", CFunctionObject), ("macro", CMacroObject)):
        app.add_directive_to_domain("c", name, type(base.__name__, (base,), {"get_signatures": get_signatures}), override=True)
