"""The site: Sphinx with MyST for Markdown and the theme Furo. ``make docs`` builds it into site/, without a network.

The source folder is the project's, so that the pages link to each other, and to the READMEs beside the code, as they do where the
files lie. What is made from the code is written into ``docs/generated`` before, by ``generate.py``.
"""

import re
import sys
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as installed
from pathlib import Path

from sphinx.ext.napoleon import Config, NumpyDocstring

sys.path.insert(0, str(Path(__file__).parents[1] / "workflow" / "src"))

suppress_warnings = ["myst.header"]  # pages may go from a title to smaller headings at once

project = "swingdown"
author = "the authors of swingdown"
project_copyright = author
try:
    release = installed("swingdown")
except PackageNotFoundError:
    release = ""  # in the environment that builds the site the package is a folder
extensions = ["myst_parser", "sphinx.ext.autodoc"]
root_doc = "docs/index"
include_patterns = [
    "README.md", "CONTRIBUTING.md", "CHANGELOG.md", "config/README.md", "docs/**", "resources/*/README.md",
]  # fmt: skip
exclude_patterns = ["**/.*"]

highlight_language = "none"  # what a block does not say is a command or what it prints
myst_enable_extensions = ["html_image"]  # a picture with a width, as the front page has one
myst_heading_anchors = 4  # links such as own-file.md#turning-points-alone
myst_links_external_new_tab = False
autodoc_typehints = "signature"
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
python_maximum_signature_line_length = 100

html_theme = "furo"
html_title = f"swingdown {release}".strip()
html_extra_path = ["entry"]  # the way in: index.html, which leads to docs/index.html
html_show_sourcelink = False
html_copy_source = False


def setup(app):
    """Docstrings have sections as numpy has them, and may write a plural such as ``Fit``s, which reStructuredText wants told apart."""
    written = Config(napoleon_custom_sections=[("Attributes", "params_style")])  # their names lead nowhere

    def sections(app, what, name, obj, options, lines):
        kind = (
            "method" if what in ("attribute", "data", "property") else what
        )  # of these a colon would end a type
        lines[:] = NumpyDocstring(lines, written, app, kind, name, obj, options).lines()

    def plurals(app, what, name, obj, options, lines):
        text = re.sub(
            r"``(.+?)``(?=(\w?))", lambda found: found[0] + ("\\ " if found[2] else ""), "\n".join(lines)
        )
        lines[:] = text.split("\n")

    app.connect("autodoc-process-docstring", sections)
    app.connect("autodoc-process-docstring", plurals)
