"""How Sphinx builds these pages: `make docs`, to docs/_build/html."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))  # the two extensions below

import fo_gym

project = "fo-gym"
author = "The fo-gym authors"
copyright = author  # without a year: the same inputs make the same pages
version = release = fo_gym.__version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "docstrings", "pages"]
exclude_patterns = ["_build", "agents/table.md"]

myst_heading_anchors = 4
myst_url_schemes = {"http": None, "https": None, "file-of-repository": {"url": "{{path}}"}}  # see pages.address
smartquotes = False  # theta' is a derivative
highlight_language = "none"  # what is indented is an equation; programs say their language
default_role = "code"

autodoc_mock_imports = ["stable_baselines3"]  # of the extra "rl", which the pages do without
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # shapes and units are said in words
autodoc_class_signature = "mixed"
napoleon_numpy_docstring = False
napoleon_use_ivar = True
napoleon_attr_annotations = False
python_use_unqualified_type_names = True
maximum_signature_line_length = 100

html_theme = "furo"
html_title = "fo-gym"
html_show_sourcelink = False
html_copy_source = False
