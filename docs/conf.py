# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""How Sphinx builds the documentation: make docs."""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

project = "lane_dp_ros"
author = "The lane_dp_ros authors"
copyright = f"2026, {author}"

extensions = [
    "build_extension",
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.viewcode",
    "sphinx_copybutton",
    "sphinxarg.ext",
    "sphinxcontrib.mermaid",
]
exclude_patterns = ["_build", "_pictures/report"]
default_role = "literal"  # docstrings set code in single backticks

myst_enable_extensions = ["colon_fence", "deflist"]
myst_heading_anchors = 3
myst_fence_as_directive = {"mermaid"}
suppress_warnings = ["misc.highlighting_failure"]

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_default_options = {"members": True}

html_theme = "sphinx_rtd_theme"  # as docs.ros.org has it
html_title = "lane_dp_ros"
html_static_path = ["_static"]
html_css_files = ["lane_dp.css"]
html_extra_path = ["_pictures/extra"]  # the report of the gallery, a page of its own
html_show_sourcelink = False
copybutton_exclude = ".linenos, .gp, .c, .c1"  # comments behind a command are for the reader
