# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters: declared once, listed, checked, replaced."""

from dataclasses import dataclass, field

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lane_dp_ros.core.parameter import Parameters, check_order, parameter, parameters, replaced


@dataclass(frozen=True)
class Stage(Parameters):
    size: int = parameter(3, "An odd number.", unit="px", limits=(1, 9), step=2)
    share: float = parameter(0.5, "A share.", limits=(0.0, 1.0))
    free: float = parameter(1.0, "Anything.", unit="m")
    mode: str = parameter("fast", "A choice.", choices=("fast", "good"))
    on: bool = parameter(True, "A switch.")

    def __post_init__(self):
        super().__post_init__()
        if self.on and self.mode == "good":
            raise ValueError("stage.mode: got good, expected fast while on")


@dataclass(frozen=True)
class Config(Parameters):
    stage: Stage = field(default_factory=Stage)
    seed: int = parameter(0, "A seed.")


@dataclass(frozen=True)
class Tuned(Parameters):
    plain: float = parameter(1.0, "For everyone.", limits=(0.0, 5.0))
    lowest: float = parameter(2.0, "For experts.", limits=(0.0, 5.0), expert=True)
    highest: float = parameter(3.0, "For experts, too.", limits=(0.0, 5.0), expert=True)

    def __post_init__(self):
        super().__post_init__()
        check_order(self, "tuned", "lowest", "highest")


@dataclass(frozen=True)
class Both(Parameters):
    tuned: Tuned = field(default_factory=Tuned)
    seed: int = parameter(0, "A seed.")


def test_nested_fields_have_dotted_names_in_order():
    assert list(parameters(Config())) == [
        "stage.size", "stage.share", "stage.free", "stage.mode", "stage.on", "seed",
    ]  # fmt: skip


def test_a_parameter_carries_what_was_declared():
    size = parameters(Config())["stage.size"]
    assert (size.name, size.default, size.description, size.unit) == ("stage.size", 3, "An odd number.", "px")
    assert (size.minimum, size.maximum, size.step, size.type) == (1, 9, 2, int)
    assert parameters(Config())["stage.mode"].choices == ("fast", "good")


def test_the_defaults_are_the_values_of_the_config_that_is_asked():
    assert parameters(Config(Stage(size=7), seed=4))["stage.size"].default == 7
    assert parameters(Config(Stage(size=7), seed=4))["seed"].default == 4


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("stage.size", "1 to 9 in steps of 2"),
        ("stage.share", "0 to 1"),
        ("stage.mode", "one of fast, good"),
        ("stage.free", ""),
        ("stage.on", ""),
    ],
)
def test_allowed_values_in_words(name, words):
    assert parameters(Config())[name].allowed == words


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("stage.size", 1), ("stage.size", 9), ("stage.share", 0.0), ("stage.share", 1.0),
        ("stage.free", -1e300), ("stage.mode", "fast"), ("stage.on", False), ("seed", -3),
    ],
)  # fmt: skip
def test_values_within_bounds_are_taken(name, value):
    assert parameters(replaced(Config(), {name: value}))[name].default == value


def test_a_whole_number_is_taken_for_a_float():
    share = replaced(Config(), {"stage.share": 1}).stage.share
    assert share == 1.0
    assert type(share) is float


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("stage.size", 4, r"stage.size: got 4, expected 1 to 9 in steps of 2"),
        ("stage.size", 11, r"stage.size: got 11, expected 1 to 9"),
        ("stage.size", 3.0, r"stage.size: got 3.0, expected a value of type int"),
        ("stage.size", True, r"stage.size: got True, expected a value of type int"),
        ("stage.share", -0.1, r"stage.share: got -0.1, expected 0 to 1"),
        ("stage.share", float("nan"), r"stage.share: got nan, expected 0 to 1"),
        ("stage.share", True, r"stage.share: got True, expected a value of type float"),
        ("stage.share", "much", r"stage.share: got 'much', expected a value of type float"),
        ("stage.free", float("inf"), r"stage.free: got inf, expected a finite number"),
        ("stage.mode", "best", r"stage.mode: got 'best', expected one of fast, good"),
        ("stage.mode", None, r"stage.mode: got None, expected a value of type str"),
        ("stage.on", 1, r"stage.on: got 1, expected a value of type bool"),
        ("stage.on", [True], r"stage.on: got \[True\], expected a value of type bool"),
        ("size", 3, r"size: no such parameter, expected one of stage.size, .*, seed"),
        ("stage", 3, r"stage: no such parameter"),
        ("stage.mode", "good", r"stage.mode: got good, expected fast while on"),
    ],
)
def test_other_values_are_refused_in_one_line_that_says_what_would_be_right(name, value, message):
    with pytest.raises(ValueError, match=message) as error:
        replaced(Config(), {name: value})
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"size": 4}, "Stage.size: got 4, expected 1 to 9 in steps of 2"),
        ({"share": float("nan")}, "Stage.share: got nan, expected 0 to 1"),
        ({"mode": "best"}, "Stage.mode: got 'best', expected one of fast, good"),
        ({"on": 1}, "Stage.on: got 1, expected a value of type bool"),
    ],
)
def test_a_stage_that_is_built_directly_is_checked_as_well(values, message):
    with pytest.raises(ValueError, match=message):
        Stage(**values)


def test_a_stage_that_is_built_directly_takes_a_whole_number_for_a_float():
    assert type(Stage(share=1).share) is float


def test_values_that_only_together_are_right_are_taken_together():
    assert replaced(Config(), {"stage.mode": "good", "stage.on": False}).stage == Stage(mode="good", on=False)


def test_replacing_leaves_the_rest_and_the_original_alone():
    config = Config()
    assert replaced(config, {"stage.size": 5, "seed": 2}) == Config(Stage(size=5), seed=2)
    assert config == Config()


@given(size=st.sampled_from([1, 3, 5, 7, 9]), share=st.floats(0, 1), on=st.booleans(), seed=st.integers())
def test_what_is_listed_can_be_put_back(size, share, on, seed):
    config = Config(Stage(size=size, share=share, on=on), seed)
    values = {name: spec.default for name, spec in parameters(config).items()}
    assert replaced(Config(), values) == config


def test_expert_parameters_are_listed_unless_they_are_left_out():
    assert list(parameters(Both())) == ["tuned.plain", "tuned.lowest", "tuned.highest", "seed"]
    assert list(parameters(Both(), expert=False)) == ["tuned.plain", "seed"]
    assert [spec.expert for spec in parameters(Both()).values()] == [False, True, True, False]


def test_expert_parameters_are_replaced_and_checked_as_others_are():
    assert replaced(Both(), {"tuned.lowest": 1.0}).tuned.lowest == 1.0
    with pytest.raises(ValueError, match=r"tuned.lowest: got 6.0, expected 0 to 5"):
        replaced(Both(), {"tuned.lowest": 6.0})


@pytest.mark.parametrize(
    ("lowest", "highest", "ordered"), [(2.9, 3.0, True), (3.0, 3.0, False), (4.0, 3.0, False)]
)
def test_two_values_may_have_to_be_in_order(lowest, highest, ordered):
    values = {"tuned.lowest": lowest, "tuned.highest": highest}
    if ordered:
        assert replaced(Both(), values).tuned == Tuned(1.0, lowest, highest)
    else:
        with pytest.raises(
            ValueError, match=rf"^tuned.highest: got 3.0, expected more than lowest = {lowest}$"
        ):
            replaced(Both(), values)
