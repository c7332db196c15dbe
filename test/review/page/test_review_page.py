# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The review page in a real Chromium: clicked and typed through as a person does."""

import json
import signal
from pathlib import Path

import numpy as np
import pytest

from lane_dp_ros.messages.bag import BagReader, BagWriter

ARROW_LEFT, SPACE = "\ue012", "\ue00d"  # as WebDriver writes them


def saved(bag: Path) -> dict:
    return json.loads(bag.with_name(f"{bag.name}.review.json").read_text())["judgements"]


def test_five_frames_by_keys_and_clicks(open_page, start_review, drive_bag) -> None:
    review = start_review(drive_bag)
    page = open_page(review.url)
    assert page.table == ("drive", "0", "0", "0", "–")
    page.type(" ")  # both are correct
    page.until_frame(2)
    page.type("1", "8")
    page.until_frame(3)
    assert "none detected" in page.text("right-note")
    assert not page.find("[data-side=right] [data-verdict=correct]").is_enabled()
    page.type(" ", "9")  # what is drawn is correct: the left one
    page.until_frame(4)
    page.verdict("left", "incorrect")
    page.until_said("Frame 4: left incorrect. Saved.")
    assert page.chosen == {"left": "incorrect"}
    page.verdict("right", "correct")
    page.until_frame(5)
    page.verdict("left", "missed")
    page.type("0")
    page.until_said("All 5 frames are judged.")
    assert page.table == ("drive", "9", "2", "2", "55.6 %")
    assert page.text("progress-text") == "5 of 5 frames judged"
    assert list(saved(drive_bag).values()) == [
        {"left": "correct", "right": "correct"},
        {"left": "correct", "right": "incorrect"},
        {"left": "correct", "right": "missed"},
        {"left": "incorrect", "right": "correct"},
        {"left": "missed", "right": "none"},
    ]
    assert review.end().splitlines()[-1] == "drive    |                   9 |         2 |      2 |    55.6 %"


def test_keys_typed_fast_meet_their_frames(open_page, served, drive_bag) -> None:
    page = open_page(served.url)
    page.type("1", "7", "2", "8", "3", "9", "2", "8", "4", "0")
    page.until_said("All 5 frames are judged.")
    said = [(each["left"], each["right"]) for each in saved(drive_bag).values()]
    assert said == [(each, each) for each in ("correct", "incorrect", "missed", "incorrect", "none")]


def test_undo_goes_back_to_the_frame(open_page, served, drive_bag) -> None:
    page = open_page(served.url)
    page.type("1", "8")
    page.until_frame(2)
    page.type("3")
    page.until_said("Frame 2: left missed. Saved.")
    page.type("u", "u")
    page.until_said("Undone: the last change, of frame 1")
    assert (page.frame, page.chosen) == (1, {"left": "correct"})
    assert page.table == ("drive", "1", "0", "0", "100.0 %")
    page.click("[data-do=undo]")
    page.wait(lambda: page.table[1] == "0")
    page.type("u")
    page.until_said("There is nothing to undo.")
    assert saved(drive_bag) == {}


def test_a_verdict_is_changed_without_moving_on(open_page, served) -> None:
    page = open_page(served.url)
    page.type(" ")
    page.until_frame(2)
    page.type(ARROW_LEFT, "2")
    page.until_said("Frame 1: left incorrect, right correct. Saved.")
    assert (page.frame, page.table[1:4]) == (1, ("2", "1", "0"))
    page.type("n")
    page.until_frame(2)


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGTERM])
def test_after_a_restart_all_is_as_it_was(open_page, start_review, drive_bag, how) -> None:
    review = start_review(drive_bag)
    page = open_page(review.url)
    page.type(" ", "2")
    page.until_said("Frame 2: left incorrect. Saved.")
    review.end(how)
    review = start_review(drive_bag)
    assert "2 frames judged" in review.said
    page = open_page(review.url)
    assert (page.frame, page.chosen) == (2, {"left": "incorrect"})
    assert page.table == ("drive", "3", "1", "0", "66.7 %")
    page.type("u")
    page.until_said("Undone: the last change, of frame 2")
    assert page.chosen == {}


def test_a_server_that_ended_is_told(open_page, start_review, drive_bag, browser) -> None:
    review = start_review(drive_bag)
    page = open_page(review.url)
    page.until_pictures_fetched(3)  # the first frame and the next two
    review.end()
    page.type("1")
    page.until_said("the server does not answer: was lane_dp review ended?")
    assert page.chosen == {}, "nothing looks saved that is not"
    assert "ERR_CONNECTION_REFUSED" in browser.get_log("browser")[0]["message"]


def test_lines_lie_on_the_lanes_and_can_be_hidden(open_page, served) -> None:
    page = open_page(served.url)
    outlines = page.all("#canvas polygon")
    assert [outline.get_attribute("class") for outline in outlines] == ["lane ego_left", "lane ego_right"]
    assert page.find("#canvas svg").accessible_name == "lines drawn: left, right"
    corners = np.array(outlines[0].get_attribute("points").replace(",", " ").split(), float).reshape(-1, 2)
    # At 4 m the line 1.8 m to the left is at u = 199.5 - 200 * 1.8 / 4, half the paint and a gap beside it.
    assert corners[0] == pytest.approx([109.5 + 200 * (0.075 + 0.05) / 4, 60 + 200 * 1.5 / 4], abs=0.02)
    page.type("l")
    page.wait(lambda: not outlines[0].is_displayed())
    page.click("#toggle")
    page.wait(outlines[0].is_displayed)


def test_a_phone_shows_it_all_without_scrolling_sideways(open_page, served, browser) -> None:
    page = open_page(served.url)
    page.resize(browser, 360, 740)
    page.click("#edit")
    page.wait(lambda: page.find("#editor").is_displayed())
    for _ in range(4):  # at every zoom, back to the first
        assert browser.execute_script("return document.documentElement.scrollWidth") == 360
        page.click("[data-do=zoom]")
    boxes = {button.accessible_name: button.rect for button in page.all("button")}
    for name, box in boxes.items():
        assert box["x"] >= 0, name
        assert box["x"] + box["width"] <= 360, name
        assert box["height"] >= 40, name
    page.verdict("left", "correct")
    page.verdict("right", "missed")
    page.until_frame(2)
    assert page.table == ("drive", "2", "0", "1", "50.0 %")


@pytest.mark.parametrize("size", [(1280, 657), (1920, 1000), (1024, 700)])
def test_every_tool_is_on_the_screen_without_scrolling(open_page, served, browser, size) -> None:
    page = open_page(served.url)
    page.resize(browser, *size)
    page.type("e")
    page.wait(lambda: page.find("#editor").is_displayed())
    assert browser.execute_script("return scrollY") == 0
    tools = page.all(".screen button, #number, #editor .hint")
    assert len(tools) == 29
    for tool in tools:
        box = tool.rect
        assert box["y"] >= 0 and box["y"] + box["height"] <= size[1], tool.accessible_name
        assert box["x"] >= 0 and box["x"] + box["width"] <= size[0], tool.accessible_name
    picture, place = page.find("#canvas img").rect, page.find("#scroll").rect
    assert picture["height"] >= 200  # not squeezed away
    assert picture["width"] / picture["height"] == pytest.approx(2, abs=0.02)
    assert picture["width"] <= place["width"] + 1 and picture["height"] <= place["height"] + 1


def test_a_phone_begins_at_the_lanes(open_page, served, browser) -> None:
    page = open_page(served.url)
    assert page.text("zoom") == "1×"  # on a desk
    page.resize(browser, 390, 844)
    browser.refresh()
    page.wait(lambda: page.all("#canvas polygon"))
    assert page.text("zoom") == "lanes"
    picture, place = page.find("#canvas img").rect, page.find("#scroll").rect
    assert picture["width"] > 1.5 * place["width"]

    def in_view(u: float, v: float) -> bool:
        x, y = picture["x"] + picture["width"] * u / 400, picture["y"] + picture["height"] * v / 200
        return (
            place["x"] <= x <= place["x"] + place["width"] and place["y"] <= y <= place["y"] + place["height"]
        )

    # 8 m ahead and 30 m: u = 199.5 + 200 x / z, v = 60 + 200 * 1.5 / z
    assert all(in_view(199.5 + 200 * x / z, 60 + 300 / z) for x in (-1.8, 1.7) for z in (8, 30))
    assert not in_view(0, 0)
    page.type(" ", " ")
    page.until_frame(3)
    assert page.text("zoom") == "lanes"
    for shown in ("1×", "2×", "4×", "lanes"):
        page.click("[data-do=zoom]")
        page.wait(lambda shown=shown: page.text("zoom") == shown)
    page.click("[data-do=zoom]")
    page.click("[data-do=next]")
    page.until_frame(4)
    assert page.text("zoom") == "1×"  # what a person chose stays


def test_everything_has_a_name_and_keys_work_from_a_button(open_page, served) -> None:
    page = open_page(served.url)
    page.type("e")
    page.wait(lambda: page.find("#editor").is_displayed())
    for element in page.all("button, input:not([hidden]), img, progress, svg, fieldset, section, nav"):
        assert element.accessible_name, element.get_attribute("outerHTML")
    page.type("e")
    page.find("[data-side=left] [data-verdict=missed]").send_keys(SPACE)  # presses it, and no more
    page.until_said("Frame 1: left missed. Saved.")
    assert page.chosen == {"left": "missed"}


def test_a_key_held_down_judges_one_frame(open_page, served, browser) -> None:
    page = open_page(served.url)
    key = {"type": "keyDown", "key": " ", "code": "Space", "windowsVirtualKeyCode": 32}
    for repeats in (False, True, True):
        browser.execute_cdp_cmd("Input.dispatchKeyEvent", {**key, "autoRepeat": repeats})
    page.until_frame(2)
    page.type("3")
    page.until_said("Frame 2: left missed. Saved.")
    assert page.text("progress-text") == "1 of 5 frames judged"


def test_a_frame_without_its_picture_is_told_and_can_be_passed(
    open_page, start_review, drive_bag, tmp_path, browser
) -> None:
    with BagReader(drive_bag) as reader, BagWriter(tmp_path / "odd") as writer:
        for topic, time_ns, message in reader.messages():
            if "image" in topic and message.data[-1] == 60:  # the first frame's
                message.encoding = "32FC1"
            writer.write(topic, time_ns, message)
    page = open_page(start_review(tmp_path / "odd").url, picture=False)
    page.until_said("The picture of frame 1 cannot be shown: encoding is '32FC1', expected one of mono8")
    assert len(page.all("#canvas polygon")) == 2
    page.type("4", "0")
    page.until_frame(2)
    assert page.find("#canvas img").is_displayed()
    assert all("400 (Bad Request)" in entry["message"] for entry in browser.get_log("browser"))
