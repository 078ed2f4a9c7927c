"""Settings of Sphinx for the book.  `python -m validate.book` calls Sphinx with this folder as its configuration."""

import json
import os
import shutil
from pathlib import Path

import sphinxcontrib.katex
from docutils import nodes

from validate.book.formulas import rendered

SOURCE = Path(os.environ["WORKBOOK_BOOK_SOURCE"])
ALTS = json.loads((SOURCE / "alts.json").read_text(encoding="utf-8"))

project = "Physics-based animation"
html_title = project
language = "en"
extensions = ["myst_nb", "sphinxcontrib.katex"]
exclude_patterns = ["_static", "extra"]

nb_execution_mode = "off"                     # they have been executed
nb_merge_streams = True
nb_render_markdown_format = "myst"            # findings are Markdown with formulas
nb_code_prompt_show = "Show the code"
nb_code_prompt_hide = "Hide the code"
nb_ipywidgets_js = {}                         # else every page asks two servers for the scripts of sliders
myst_enable_extensions = ["dollarmath", "amsmath"]
myst_dmath_double_inline = True               # else $$…$$ within a paragraph is set inline
python_display_short_literal_types = True
add_module_names = False
toc_object_entries_show_parents = "hide"

katex_prerender = shutil.which("node") is not None             # else the same KaTeX runs in the reader's browser
sphinxcontrib.katex.render_latex = rendered
katex_css_path = "katex/katex.min.css"

html_theme = "furo"
html_static_path = [str(SOURCE / "_static")]
html_css_files = ["book.css"]
html_js_files = ["book.js"]
html_favicon = str(SOURCE / "_static" / "favicon.svg")
html_extra_path = [str(SOURCE / "extra")]
html_copy_source = html_show_sphinx = html_show_copyright = html_show_sourcelink = False
html_show_search_summary = False              # summaries fetch pages, which file:// forbids
html_theme_options = {"top_of_page_buttons": [],
                      "light_css_variables": {"color-brand-primary": "#0067a3", "color-brand-content": "#0067a3",
                                              "color-brand-visited": "#6b3fa0"},
                      "dark_css_variables": {"color-brand-primary": "#6cb8ff", "color-brand-content": "#6cb8ff",
                                             "color-brand-visited": "#c3a6ff"}}


NAMED = {'<th class="head"><p></p></th>': '<td class="head"></td>',           # the corner of a table
         'class="caption" role="heading"': 'class="caption" role="heading" aria-level="2"',
         '<aside class="sidebar-drawer">': '<aside class="sidebar-drawer" aria-label="Contents of the book">',
         '<aside class="toc-drawer': '<aside aria-label="Contents of this page" class="toc-drawer',
         '<summary aria-label="Toggle hidden content">': "<summary>",       # its text says what it does
         '<div id="search-results"></div>': '<h1>Search</h1><div id="search-results"></div>'}


def describe_figures(app, doctree):
    """Give each figure of a notebook the description that its kernel made."""
    for image in doctree.findall(nodes.image):
        if Path(image["uri"]).stem in ALTS:
            image["alt"] = ALTS[Path(image["uri"]).stem]


def name_parts(app, exception):
    """Give the parts of each page the names and levels that a screen reader needs and the theme leaves out."""
    for path in [] if exception else Path(app.outdir).rglob("*.html"):
        if path.relative_to(app.outdir).parts[0] != "report":
            text = path.read_text(encoding="utf-8")
            for old, new in NAMED.items():
                text = text.replace(old, new)
            path.write_text(text, encoding="utf-8")


def setup(app):
    app.connect("doctree-read", describe_figures)
    app.connect("build-finished", name_parts)
