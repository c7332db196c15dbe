# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Lines are corrected on the review page, in a real Chromium, and exported as truth."""

import json
from pathlib import Path

import numpy as np
import pytest

from lane_dp_ros.core.geometry.quadratic_surface import QuadraticSurface
from lane_dp_ros.tools.evaluation.truth_file import load_truth

ARROW_RIGHT = "\ue014"  # as WebDriver writes it


def saved(bag: Path) -> dict:
    return json.loads(bag.with_name(f"{bag.name}.review.json").read_text())["judgements"]


def test_a_point_is_dragged_and_exported(open_page, served, drive_bag, browser, tmp_path) -> None:
    behaviour = {"behavior": "allow", "downloadPath": str(tmp_path / "downloads")}
    browser.execute_cdp_cmd("Browser.setDownloadBehavior", behaviour)
    page = open_page(served.url)
    page.type("2", "e")
    page.wait(lambda: len(page.all("circle")) == 2)
    assert "selected" in page.all("polyline.line")[0].get_attribute("class")
    before = json.loads(browser.execute_script("return (await (await fetch('/api/frames/0')).text())"))[
        "lines"
    ]
    picture, point = page.find("#canvas img").rect, page.all("circle")[0].rect
    scale = picture["width"] / 400  # screen pixels to a pixel of the image
    # A point stands on its pixel's centre.
    u = (point["x"] + point["width"] / 2 - picture["x"]) / scale - 0.5
    assert u == pytest.approx(before[0]["uv"][0][0], abs=0.35)
    page.drag(page.all("circle")[0], 40, 0)
    page.until_said("Frame 1: lines corrected. Saved.")
    uv = saved(drive_bag)["1317000000000000000"]["lines"][0]["uv"]
    assert uv[0] == pytest.approx([before[0]["uv"][0][0] + 40 / scale, before[0]["uv"][0][1]], abs=0.15)
    assert uv[1] == before[0]["uv"][1]
    page.type("7")
    page.until_frame(2)
    assert not page.find("#editor").is_displayed()
    page.click("[data-do=export]")
    page.wait(lambda: page.text("exported") == "drive.truth.json: 1 frames")
    path = tmp_path / "downloads" / "drive.truth.json"
    page.wait(path.exists)
    (frame,) = load_truth(path)
    line = next(label for label in frame.labels if label.id == frame.ego_left)
    plane = QuadraticSurface.plane(frame.camera, height=1.5, pitch=0.0)
    x, z = plane.pixel_to_ground(*np.array(uv[:1]).T)
    np.testing.assert_allclose(line.xz[0], [x[0], z[0]], atol=0.02)
    np.testing.assert_allclose(line.xz[-1, 0], -1.8, atol=0.1)


def lines_of(bag: Path) -> list[dict]:
    return saved(bag)["1317000000000000000"]["lines"]


def test_lines_and_points_come_and_go(open_page, served, drive_bag) -> None:
    page = open_page(served.url)

    def type_and_read(*keys: str) -> list[dict]:
        page.type(*keys)
        page.until_said("Saved.")
        page.browser.execute_script("document.getElementById('status').textContent = ''")
        return lines_of(drive_bag)

    page.type("e")
    assert [line["id"] for line in type_and_read("x")] == ["8", "9"]
    added = type_and_read("a")[-1]
    assert (added["role"], added["kind"], added["sure"], len(added["uv"])) == ("ego_left", "solid", True, 2)
    assert added["id"] == "new1"
    assert type_and_read("k")[-1]["kind"] == "dashed"
    assert page.text("kind") == "dashed"
    assert not type_and_read("s")[-1]["sure"]
    assert len(type_and_read("p")[-1]["uv"]) == 3
    assert page.text("point") == "point 2 of 3"
    (u, v), moved = lines_of(drive_bag)[-1]["uv"][1], type_and_read(ARROW_RIGHT)[-1]["uv"][1]
    assert moved == pytest.approx([u + 0.5, v], abs=0.06)
    assert len(type_and_read("d")[-1]["uv"]) == 2
    page.type("d")  # two points make a line: none goes
    roles = [line["role"] for line in type_and_read("r")]
    assert roles == ["other", "other", "ego_right"], "the right line gave its role to this one"
    page.click("[data-do=detected]")
    page.until_said("back to the detected lines")
    assert saved(drive_bag) == {}
    page.type("u")
    page.until_said("Undone")
    assert [line["role"] for line in lines_of(drive_bag)] == roles


def test_a_double_click_adds_a_point_on_the_line(open_page, served, drive_bag) -> None:
    page = open_page(served.url)
    page.click("#edit")
    page.wait(lambda: page.all("polyline.grip"))
    # The left line at 6 m: u = 199.5 - 200 * 1.8 / 6, v = 60 + 200 * 1.5 / 6.
    scale = page.find("#canvas img").size["width"] / 400
    page.double_click("#canvas img", (140 - 200) * scale, (110.5 - 100) * scale)
    page.until_said("Frame 1: lines corrected. Saved.")
    uv = next(line for line in lines_of(drive_bag) if line["role"] == "ego_left")["uv"]
    assert uv[1] == pytest.approx([139.5, 110], abs=0.4)
    assert len(uv) == 3
    page.click("#edit")
    # What is judged stays what was detected.
    page.wait(lambda: len(page.all("#canvas polygon")) == 2 and not page.all("polyline"))
    assert page.text("edit-text") == "Corrected lines"


@pytest.mark.parametrize(("form", "ending"), [("Coco", ".json"), ("Cvat", ".xml")])
def test_lines_go_out_to_a_tool_and_come_back(open_page, served, drive_bag, tmp_path, form, ending) -> None:
    page = open_page(served.url)
    behaviour = {"behavior": "allow", "downloadPath": str(tmp_path / "downloads")}
    page.browser.execute_cdp_cmd("Browser.setDownloadBehavior", behaviour)
    page.click(f"[data-do=export{form}]")
    name = f"drive.{form.lower()}{ending}"
    page.wait(lambda: page.text("exported") == f"{name}: 5 frames")
    path = tmp_path / "downloads" / name
    page.wait(path.exists)
    # What the tool does: the left line's near end is moved by two pixels, in all four frames that have one.
    path.write_text(path.read_text().replace("110", "112"))
    page.type("e")
    page.find("#file").send_keys(str(path))
    page.wait(lambda: page.text("exported") == f"{name}: 5 images, lines of 4 frames changed")
    assert lines_of(drive_bag)[0]["uv"][0] == [111.5, 135.0]
    page.wait(lambda: page.all("circle")[0].get_attribute("cx") == "111.5")
    assert page.text("edit-text") == "Corrected lines"
    page.click("[data-do=undo]")
    page.until_said("Undone: the last change, of frame 4")


def test_a_file_that_cannot_be_imported_is_told(open_page, served, browser, tmp_path) -> None:
    (wrong := tmp_path / "wrong.xml").write_text("<svg/>")
    page = open_page(served.url)
    page.find("#file").send_keys(str(wrong))
    page.until_said("wrong.xml: the XML is <svg>, expected <annotations> of CVAT for images")
    assert all("400 (Bad Request)" in entry["message"] for entry in browser.get_log("browser"))
    wrong.write_text("x")  # the same name again
    page.find("#file").send_keys(str(wrong))
    page.until_said("wrong.xml: no whole JSON")
    assert all("400 (Bad Request)" in entry["message"] for entry in browser.get_log("browser"))
