"""Sphinx configuration; the pages of the gallery are made by running the examples."""

import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)

from make_gallery import make_gallery  # noqa: E402
from make_reference import make_reference  # noqa: E402
from make_rooms import make_rooms  # noqa: E402
from make_tutorials import make_tutorials  # noqa: E402
from make_verification import make_verification  # noqa: E402

make_gallery()
make_rooms()
make_reference()
make_tutorials()
make_verification()

project = "visviva"
author = "the visviva developers"
copyright = "2026, the visviva developers"
release = "0.2.0"

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.mathjax",
    "sphinx.ext.viewcode",
    "numpydoc",
]
extensions += ["sphinx_copybutton", "sphinx_design", "sphinx-mathjax-offline"]  # formulas need no network
extensions += ["sphinx_codeautolink", "linked_names"]  # names in code and text lead to their pages
exclude_patterns = ["_build"]
default_role = "code"
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
python_maximum_signature_line_length = 90
autodoc_class_signature = "mixed"
numpydoc_show_class_members = False
numpydoc_class_members_toctree = False
numpydoc_validation_checks = set()

# lines with flags of doctest, fragments of code, and pages of an earlier build that have their links
suppress_warnings = ["codeautolink"]
copybutton_prompt_text = r">>> |\.\.\. |\$ "
copybutton_prompt_is_regexp = True

html_theme = "furo"
html_title = "visviva"
html_static_path = ["visviva.css"]
html_css_files = ["visviva.css"]
