# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What the code itself tells the documentation: pictures, a table of every parameter, docstrings."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, ClassVar

import draw_gallery
import draw_method
import draw_results
from docutils import nodes
from docutils.parsers.rst import directives
from docutils.statemachine import StringList
from sphinx.application import Sphinx
from sphinx.ext.napoleon import Config, GoogleDocstring
from sphinx.util.docutils import SphinxDirective

from lane_dp_ros.core.parameter import Parameter
from lane_dp_ros.messages.node_config import all_parameters

HERE = Path(__file__).resolve().parent
PICTURES = HERE / "_pictures"
MADE = PICTURES / "made"


class ParameterTable(SphinxDirective):
    """Lists the parameters of the node that anybody may set, or those of experts alone, stage by stage."""

    option_spec: ClassVar[dict[str, Any]] = {"expert": directives.flag}

    def run(self) -> list[nodes.Node]:
        """Return a section's content: a heading and a table for each stage."""
        lines = StringList(list(self._lines()), source="parameters")
        parent = nodes.container()
        self.state.nested_parse(lines, self.content_offset, parent, match_titles=True)
        return parent.children

    def _lines(self) -> Iterator[str]:
        expert = "expert" in self.options
        stage = None
        specs = [spec for spec in all_parameters(expert=True).values() if spec.expert == expert]
        for spec in sorted(specs, key=lambda spec: "." in spec.name):
            if (here := spec.name.rpartition(".")[0]) != stage:
                stage = here
                yield from ["", f"**{stage or 'the node itself'}**", ""]
                yield from ["| parameter | default | unit | allowed | |", "|---|---|---|---|---|"]
            yield _row(spec)


def _row(spec: Parameter) -> str:
    default = str(spec.default).lower() if isinstance(spec.default, bool) else str(spec.default)
    cells = f"`{spec.name}`", f"`{default}`", spec.unit, spec.allowed, spec.description
    return f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"


def draw_pictures(_app: Sphinx) -> None:
    """Draw all pictures, unless none of what they are made of changed since."""
    sources = [*HERE.glob("draw_*.py"), HERE / "results.md", *(HERE.parent / "lane_dp_ros").rglob("*.py")]
    if MADE.exists() and MADE.stat().st_mtime > max(source.stat().st_mtime for source in sources):
        return
    for script in (draw_method, draw_results, draw_gallery):
        script.main(PICTURES)
    MADE.touch()


def as_restructured_text(_app: Sphinx, what: str, _name: str, _obj: Any, *options_and_lines: Any) -> None:
    """Write the sections "Args:" and so on of a docstring as reStructuredText.

    Not of a field's: of a sentence with a colon in it, napoleon would take the first half for a type.
    """
    lines: list[str] = options_and_lines[-1]
    if what not in ("attribute", "property"):
        lines[:] = GoogleDocstring(lines, Config(napoleon_use_rtype=False)).lines()


def readable_signature(*names_and_parts: Any) -> tuple[str, str] | None:
    """Return a signature without the `<factory>` of fields, which Sphinx cannot parse."""
    *_, signature, returns = names_and_parts
    return None if signature is None else (re.sub(r"<[^<>]*>", "...", signature), returns)


def setup(app: Sphinx) -> dict[str, Any]:
    """Add all that to Sphinx."""
    app.setup_extension("sphinx.ext.autodoc")
    app.add_directive("parameter-table", ParameterTable)
    app.connect("config-inited", lambda app, _config: draw_pictures(app))
    app.connect("autodoc-process-docstring", as_restructured_text)
    app.connect("autodoc-process-signature", readable_signature)
    return {"parallel_read_safe": True}
