# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The default pipeline's parameters: at most 40, each in docs/tuning.md, each tried by the benchmark."""

import importlib
import sys
from dataclasses import fields, is_dataclass
from pathlib import Path

import pytest
import study_runner
import tuning

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.parameter import parameters
from lane_dp_ros.core.pipeline import LanePipeline
from lane_dp_ros.tools.evaluation.summary import Summary

ALL = parameters(DetectorConfig())
SPECS = parameters(DetectorConfig(), expert=False)
# Their other value is the paper's formula; the default pipeline reads them to know that.
CHOICES = {
    "road_profile.model",
    "vanishing_point.method",
    "paint_map.feature",
    "path_search.free_ends",
    "lane_model.model",
    "lane_selection.evidence",
}
COPYING = {"dataclasses", "lane_dp_ros.core.parameter"}  # copy and check every field of a config
PAGE = Path(__file__).parents[2] / "docs" / "tuning.md"
TABLE, REST = PAGE.read_text(encoding="utf-8").split("\n## Measured\n")
MEASURED, BY_HAND = REST.split("\n## Numbers chosen by hand that decide what a lane is\n")
FILES = {"lane_selection.evidence_model"}  # parameters with nothing lower or higher to try
GOOD = Summary(frames=10, ego_labels=20, missed=1, labels=40, matched=38, detections=39, false_lanes=1)
WORSE = Summary(frames=10, ego_labels=20, missed=2, labels=40, matched=38, detections=40, false_lanes=3)
BARE = Summary(frames=10)


def rows(text):
    """Return the cells of each line of a table that is about a parameter."""
    cells = [[cell.strip() for cell in line.split("|")[1:-1]] for line in text.splitlines()]
    return [row for row in cells if row and row[0].startswith("`")]


def text_of(value):
    return str(value).lower() if isinstance(value, bool) else f"{value:g}"


@pytest.fixture
def read(monkeypatch):
    """Return the set of the dotted names of parameters, to which each that is read is added."""
    names = set()

    def watch(config, prefix):
        kind = type(config)
        own = {field.name for field in fields(config)}

        def getattribute(self, name):
            if name in own and sys._getframe(1).f_globals["__name__"] not in COPYING:
                names.add(prefix + name)
            return object.__getattribute__(self, name)

        for name in own:
            if is_dataclass(getattr(config, name)):
                watch(getattr(config, name), f"{name}.")
        monkeypatch.setattr(kind, "__getattribute__", getattribute)

    watch(DetectorConfig(), "")
    names.clear()
    return names


def test_the_default_pipeline_has_at_most_40_parameters():
    count = len(tuning.TRIED) + len(FILES)
    assert count <= 40
    assert f"The default pipeline has {count} parameters." in TABLE
    assert f"## The {count} parameters" in TABLE
    assert len(SPECS) - count == 14 and "Fourteen more parameters choose the paper's" in TABLE
    assert len(ALL) - len(SPECS) == 27 and "Twenty-seven more are for experts" in TABLE


def test_what_is_tried_is_what_the_default_pipeline_reads(pairs, read):
    config, pipeline = DetectorConfig(), LanePipeline()
    read.clear()
    for pair in pairs:
        assert len(pair.followed(config, pipeline).lanes) == 3
    assert read & set(SPECS) == set(tuning.TRIED) | CHOICES | FILES


def test_each_parameter_has_one_complete_row_in_the_table_and_no_other_has():
    table = rows(TABLE)
    assert sorted(row[0] for row in table) == sorted(f"`{name}`" for name in {*tuning.TRIED, *FILES})
    for row in table:
        assert len(row) == 7, row[0]
        assert all(row[i] for i in (0, 1, 3, 4, 5, 6)), row[0]


@pytest.mark.parametrize("text", [TABLE, MEASURED], ids=["table", "measured"])
def test_defaults_and_units_of_the_tables_are_those_of_the_code(text):
    given = {row[0]: row[1:3] for row in rows(text) if row[0].strip("`") not in FILES}
    assert given == {f"`{name}`": [text_of(SPECS[name].default), SPECS[name].unit] for name in tuning.TRIED}


def test_the_measured_table_is_of_the_values_that_are_tried():
    tried = {row[0].strip("`"): row[3] for row in rows(MEASURED)}
    assert tried == {name: " / ".join(map(text_of, values)) for name, values in tuning.TRIED.items()}


def test_a_file_stands_in_the_table_with_its_default():
    given = {row[0].strip("`"): row[1] for row in rows(TABLE)}
    assert {name: given[name] for name in FILES} == {name: SPECS[name].default for name in FILES}


def by_hand():
    """Return the numbers of the table of those chosen by hand, by where they stand."""
    return {row[0].strip("`"): row[1] for row in rows(BY_HAND)}


def number_of(where):
    """Return a parameter's default, or a constant of a module of the core."""
    if where in ALL:
        return ALL[where].default
    module, _, name = where.rpartition(".")
    return getattr(importlib.import_module(f"lane_dp_ros.core.{module}"), name)


def test_numbers_chosen_by_hand_are_those_of_the_code():
    assert by_hand() == {where: f"{number_of(where):g}" for where in by_hand()}
    assert f"There are {len(by_hand())} of them" in BY_HAND


def test_every_number_of_the_stages_that_propose_and_select_is_among_those_chosen_by_hand():
    stages = ("path_search", "lane_selection", "extension", "parallel", "stop_line", "axis_refinement")
    of_paper = {"path_search.neighbours", "path_search.smoothness", "path_search.max_mean_cost"}
    numbers = {
        name for name, spec in ALL.items() if name.split(".")[0] in stages and spec.type in (int, float)
    }
    assert len(numbers) >= 25
    assert numbers - of_paper <= set(by_hand())


def test_names_in_the_text_exist():
    named = {word.strip(".,;:()") for word in TABLE.replace("`", " ").split() if "." in word.strip(".,;:()")}
    of_stages = {name for name in named if name.split(".")[0] in {spec.split(".")[0] for spec in ALL}}
    assert len(of_stages) > 30
    assert of_stages <= set(ALL)


@pytest.mark.parametrize("name", tuning.TRIED)
def test_a_lower_and_a_higher_value_are_tried_where_there_are_any(name):
    spec, values = SPECS[name], tuning.TRIED[name]
    assert all(spec.checked(value) == value != spec.default for value in values)
    if spec.type is not bool:
        lower, higher = (any(sign * value > sign * spec.default for value in values) for sign in (-1, 1))
        assert lower or spec.default == spec.minimum
        assert higher or spec.default == spec.maximum


def test_shares_change_in_points_and_counts_by_number():
    precision, false = tuning.QUALITY[0], tuning.FALSE
    assert tuning.change(GOOD, WORSE, precision) == "-5.0"
    assert tuning.change(WORSE, GOOD, precision) == "+5.0"
    assert tuning.change(GOOD, GOOD, precision) == "0"
    assert tuning.change(GOOD, WORSE, false) == "+2"
    assert tuning.change(GOOD, BARE, precision) == "-"


def test_a_row_has_a_cell_under_each_head_and_a_number_for_each_value():
    before, after = {"labelled frames": GOOD, "06": BARE}, {"labelled frames": WORSE, "06": BARE}
    row = tuning.row("lane_selection.confidence_min", before, [before, after])
    assert {line.count("|") for line in [*tuning.heads(before).splitlines(), row]} == {row.count("|")}
    assert row.startswith("| `lane_selection.confidence_min` | 0.3 |  | 0.15 / 0.6 | 0 / -5.0 | 0 / 0 | ")
    assert row.endswith("| 0 / 0 |")


def test_frames_are_told_apart_by_what_they_are_of(pairs):
    lanes = pairs[0].detected(DetectorConfig()).lanes
    scene = pairs[0].judged(lanes)
    unpainted = study_runner.judge_unpainted(
        f"{study_runner.UNPAINTED}/000000", lanes, study_runner.UNPAINTED, 0
    )
    found = tuning.summaries([scene, unpainted])
    assert found["06"].false_lanes == 3
    assert [each for each in found if each != "06"] == ["suite" if scene.category else "labelled frames"]


@pytest.mark.parametrize(
    ("given", "said"),
    [(["none"], "none"), (["none", "--only", "colour"], "no parameter has 'colour' in its name")],
)
def test_what_is_not_there_is_one_line(given, said, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["tuning.py", *given])
    assert tuning.main() == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and said in error
