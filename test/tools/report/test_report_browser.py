# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The report in a headless Chromium, as a person sees and uses it."""

from pathlib import Path

import numpy as np
import pytest

from lane_dp_ros.messages.bag import BagWriter
from lane_dp_ros.messages.stereo_bag import StereoBagWriter, StereoImages
from lane_dp_ros.scenes import CAMERA
from lane_dp_ros.tools.evaluation.changes import compare
from lane_dp_ros.tools.evaluation.json_file import EvaluationFile
from lane_dp_ros.tools.evaluation.matching import judge
from lane_dp_ros.tools.report import write_changes_report, write_report

WIDTHS = {"desktop": 1280, "phone": 390}
P_LEFT = CAMERA.P_left
P_RIGHT = P_LEFT - np.array([[0, 0, 0, CAMERA.fx * CAMERA.baseline], [0] * 4, [0] * 4])


@pytest.fixture(scope="module")
def report(tmp_path_factory, results, frames) -> Path:
    """Return a page; its images are noise, in which there is no road, and the last frame has none."""
    folder = tmp_path_factory.mktemp("report")
    noise = np.random.default_rng(0).integers(60, 120, (375, 1242), dtype=np.uint8)
    with BagWriter(folder / "noise") as writer:
        bag = StereoBagWriter(writer, P_LEFT, P_RIGHT)
        for frame in frames[:3]:
            bag.write(StereoImages(frame.stamp_ns, noise, noise))
    return write_report(results, folder / "noise", folder / "out")


@pytest.fixture(scope="module")
def changes_report(tmp_path_factory, report, results):
    """Return the page of a comparison with a detector that found nothing, in the images of `report`."""
    files = [
        EvaluationFile(Path(name), tuple(each))
        for name, each in (("A", [judge(r.truth, (), CAMERA) for r in results]), ("B", results))
    ]
    names = files[0].path, files[1].path
    folder = tmp_path_factory.mktemp("changes")
    return write_changes_report(compare(*files), names, report.parents[1] / "noise", folder / "out")


def opened(browser, page, width):
    """Return the browser with a page open."""
    metrics = {"width": width, "height": 800, "deviceScaleFactor": 1, "mobile": width < 600}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
    browser.get_log("browser")  # what another page said
    browser.get(page.as_uri())
    return browser


@pytest.fixture(params=WIDTHS)
def page(request, browser, report):
    return opened(browser, report, WIDTHS[request.param])


@pytest.fixture(params=WIDTHS)
def changes_page(request, browser, changes_report):
    return opened(browser, changes_report, WIDTHS[request.param])


def test_it_fits_the_screen_and_nothing_goes_wrong(page):
    assert page.execute_script("return document.documentElement.scrollWidth <= innerWidth")
    assert page.get_log("browser") == []  # nor does its own security policy refuse anything
    assert min(heights(page, ".chart .bar")) > 1
    assert min(heights(page, ".chart text")) > 8  # it can be read


def heights(page, selector):
    """Return how high each of these elements is [px]."""
    found = "return [...document.querySelectorAll(arguments[0])]"
    return page.execute_script(f"{found}.map((each) => each.getBoundingClientRect().height)", selector)


def test_the_tables_first_column_stays_when_they_scroll(page):
    script = """
        const box = document.querySelectorAll('#numbers .scroll')[1];
        box.scrollLeft = 200;
        const cell = box.querySelector('tbody th');
        return [cell.getBoundingClientRect().left - box.getBoundingClientRect().left];
    """
    assert page.execute_script(script)[0] <= 2


def test_pictures_are_shown_with_their_lines_over_them(page):
    script = """
        const image = document.querySelector('#frame-1 img');
        image.loading = 'eager';
        await image.decode();
        const line = document.querySelector('#frame-1 figure.left .lane.false:not(.casing)');
        const [box, of] = [line.getBoundingClientRect(), image.getBoundingClientRect()];
        return [image.naturalWidth, of.width, box.left >= of.left, box.right <= of.right + 1, box.height > 0,
                getComputedStyle(line).stroke];
    """
    natural, width, *within, stroke = page.execute_script(script)
    assert natural == 1242 and width > 300 and all(within)
    assert stroke == "rgb(255, 122, 28)"


def test_a_click_enlarges_and_keys_go_on(page):
    left, *_ = page.find_elements("css selector", ".pictures figure")
    small = left.size["width"]
    left.click()
    dialog = page.find_element("id", "large")
    assert dialog.is_displayed()
    assert dialog.find_element("css selector", "figure").size["width"] > small
    assert dialog.find_element("css selector", "p").text == "1. drive/<b>&"
    dialog.send_keys("\ue014")  # arrow to the right
    assert dialog.find_element("css selector", "figcaption").text == "From above"
    page.find_element("id", "next").click()
    assert dialog.find_element("css selector", "p").text == "2. drive/blind"
    page.find_element("id", "previous").click()
    page.find_element("id", "previous").click()
    assert dialog.find_element("css selector", "p").text == "1. drive/<b>&"
    dialog.send_keys("\ue00c")  # escape
    assert not dialog.is_displayed()
    assert page.switch_to.active_element == left


def test_labels_can_be_hidden(page):
    label = page.find_element("css selector", "#frame-2 .canvas .label.missed")
    assert label.is_displayed()
    page.find_element("id", "show-labels").click()
    assert not label.is_displayed()
    assert page.find_element("css selector", "#frame-2 .canvas .lane.right").is_displayed()


def test_failures_and_curves_come_before_the_numbers(page):
    tops = [page.find_element("id", name).rect["y"] for name in ("failures", "curves", "gallery", "numbers")]
    assert tops == sorted(tops)
    page.find_element("css selector", "#failures tbody a").click()
    assert page.execute_script("return location.hash") == "#frame-1"


def cells(page, selector, column):
    """Return the texts of a column."""
    found = "return [...document.querySelectorAll(arguments[0])]"
    script = f"{found}.map((row) => row.cells[arguments[1]].textContent)"
    return page.execute_script(script, f"{selector} tbody tr", column)


def test_a_click_on_a_head_sorts_the_table(page):
    """The classes of failures: over-exposure 1 missed, similar objects and the unknown none; then by name."""
    table = "#failures .pair section:last-child table"
    name, missed = page.find_elements("css selector", f"{table} thead th")[:2]
    names = ["over-exposure", "similar objects", "not known"]
    assert cells(page, table, 0) == names
    name.click()
    assert cells(page, table, 0) == sorted(names) and name.get_attribute("aria-sort") == "ascending"
    missed.send_keys("\ue007")  # the key Enter
    assert cells(page, table, 1) == ["1", "·", "·"]
    assert missed.get_attribute("aria-sort") == "descending" and name.get_attribute("aria-sort") == "none"
    missed.click()
    assert cells(page, table, 1) == ["·", "·", "1"]


def test_the_total_stays_at_the_end(page):
    table = "#numbers .pair:nth-of-type(2) section:first-child table"  # by category
    head = page.find_element("css selector", f"{table} thead th")
    for order in (["kerbs", "over_exposure", "total"], ["over_exposure", "kerbs", "total"]):
        head.click()
        assert cells(page, table, 0) == order


def test_a_comparison_fits_the_screen_and_shows_both_sides(changes_page):
    assert changes_page.execute_script("return document.documentElement.scrollWidth <= innerWidth")
    assert changes_page.get_log("browser") == []
    left, right = changes_page.find_elements("css selector", "#frame-1 .sides figure")
    captions = [each.find_element("css selector", "figcaption").text for each in (left, right)]
    assert captions == ["A", "B"]
    assert len(left.find_elements("css selector", ".canvas polyline.label.missed:not(.casing)")) == 2
    assert right.find_elements("css selector", ".canvas polyline.lane") != []
    left.click()
    dialog = changes_page.find_element("id", "large")
    dialog.send_keys("\ue014")  # arrow to the right: the same frame, afterwards
    assert dialog.find_element("css selector", "figcaption").text == "B"
    dialog.send_keys("\ue00c")  # escape


def test_changed_frames_are_sorted_by_how_much_they_changed(changes_page):
    table = "#frames table"
    names = cells(changes_page, table, 0)
    assert names == ["drive/fine", "drive/plain", "drive/<b>&", "drive/blind"]
    head = changes_page.find_elements("css selector", f"{table} thead th")[1]
    head.click()
    assert cells(changes_page, table, 0) == names
    head.click()
    assert cells(changes_page, table, 0)[2:] == ["drive/plain", "drive/fine"]  # the other two are equal
