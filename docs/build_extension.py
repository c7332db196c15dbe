# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What the code itself tells the documentation: its pictures, and a directive that lists every parameter."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import draw_gallery
import draw_method
import draw_results
from docutils import nodes
from docutils.statemachine import StringList
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from lane_dp_ros.core.parameter import Parameter
from lane_dp_ros.messages.node_config import all_parameters

HERE = Path(__file__).resolve().parent
PICTURES = HERE / "_pictures"
MADE = PICTURES / "made"


class ParameterTable(SphinxDirective):
    """Lists the parameters of the node that anybody may set, or those of experts alone, stage by stage."""

    option_spec = {"expert": lambda _: True}

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


def setup(app: Sphinx) -> dict[str, Any]:
    """Add both to Sphinx."""
    app.add_directive("parameter-table", ParameterTable)
    app.connect("config-inited", lambda app, _config: draw_pictures(app))
    return {"parallel_read_safe": True}
