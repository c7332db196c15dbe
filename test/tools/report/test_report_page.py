# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The report's page: well-formed, by itself, the summary's numbers; its gallery from bags and folders."""

import base64
import re
from dataclasses import replace
from html.parser import HTMLParser

import cv2
import numpy as np
import pytest

from lane_dp_ros.core.config import preset
from lane_dp_ros.core.detector import LaneDetector
from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.messages.bag import BagWriter, bag_message
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.image import image_to_ros
from lane_dp_ros.messages.stamp import stamp_to_ros
from lane_dp_ros.scenes import CAMERA
from lane_dp_ros.tools.cli import main
from lane_dp_ros.tools.evaluation.annotations import Label
from lane_dp_ros.tools.evaluation.depth import CURVE_DEPTHS, NO_SURFACE, DepthErrors
from lane_dp_ros.tools.evaluation.json_file import read_json, write_json
from lane_dp_ros.tools.evaluation.matching import judge
from lane_dp_ros.tools.evaluation.scores import FrameScore
from lane_dp_ros.tools.evaluation.summary import by_sequence, summarise
from lane_dp_ros.tools.evaluation.truth_file import save_truth
from lane_dp_ros.tools.report import write_report, write_surface_report
from lane_dp_ros.tools.report.figure import data_uri
from lane_dp_ros.tools.report.pictures import LEFT_BYTES

VOID = {"meta", "img", "input", "br", "wbr"}


class Parsed(HTMLParser):
    """Elements as (tag, attributes, text), tables as lists of rows; every element must be closed in order."""

    def __init__(self, text):
        super().__init__()
        self.open, self.all, self.tables = [], [], []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attributes):
        element = [tag, dict(attributes), ""]
        assert len(element[1]) == len(attributes), f"an attribute twice in {tag}: {attributes}"
        self.all.append(element)
        if tag not in VOID:
            self.open.append(element)
        if tag == "table":
            self.tables.append([])
        if tag == "tr":
            self.tables[-1].append([])

    def handle_startendtag(self, tag, attributes):
        self.all.append([tag, dict(attributes), ""])

    def handle_endtag(self, tag):
        element = self.open.pop()
        assert element[0] == tag, f"<{element[0]}> is closed by </{tag}>"
        if tag in ("td", "th"):
            self.tables[-1][-1].append(element[2])

    def handle_data(self, data):
        for element in self.open:
            element[2] += data

    def texts(self, tag, style=""):
        return [
            text
            for name, attributes, text in self.all
            if name == tag and style in attributes.get("class", "")
        ]

    def count(self, tag, style):
        return len(self.texts(tag, style))


@pytest.fixture
def empty_bag(tmp_path):
    """Return a bag without any image, of a name that a page must not take for its own."""
    bag = tmp_path / "lanes <b>&"
    with BagWriter(bag) as writer:
        writer.write("/lanes", 1, bag_message("visualization_msgs/msg/MarkerArray", markers=[]))
    return bag


@pytest.fixture
def page(tmp_path, results, empty_bag):
    return Parsed(write_report(results, empty_bag, tmp_path / "report").read_text(encoding="utf-8"))


def assert_by_itself(parsed):
    for _, attributes, _ in parsed.all:
        assert attributes.get("src", "data:").startswith("data:image/jpeg;base64,") or "src" not in attributes
        assert attributes.get("href", "#").startswith("#")
    style = "".join(parsed.texts("style"))
    assert "url(" not in style and "@import" not in style
    assert "default-src 'none'" in next(a for _, a, _ in parsed.all if a.get("http-equiv"))["content"]
    text = "".join(parsed.texts("html"))
    assert "http:" not in text and "https:" not in text and "//cdn" not in text


def test_the_page_is_by_itself(page):
    assert_by_itself(page)
    assert page.texts("h1") == ["Lane detection judged: lanes <b>&"]


def test_the_tables_hold_the_summarys_numbers(page, results):
    paper, today, categories, *_ = (table for table in page.tables if table[0][0] in ("sequence", "category"))
    total = summarise(results)
    assert paper[0] == ["sequence", "total lanemarkings", "incorrect", "missed", "precision"]
    assert paper[1:] == [["drive", "8", "0", "1", "0.875"], ["total", "8", "0", "1", "0.875"]]
    heads = ["sequence", "frames", "recall", "detectionprecision", "strict", "falseper frame", "strict"]
    assert today[0][:7] == heads
    precision = f"{total.detection_precision:.3f}"
    assert today[-1][:7] == [
        "total",
        "4",
        f"{total.lane_recall:.3f}",
        precision,
        precision,
        "0.25",
        "0.25",
    ]
    assert today[-1][7:10] == [
        f"{e:.3f}" for e in (total.localisation_error, total.near_error, total.far_error)
    ]
    assert today[0][10:] == ["idswitches"] and today[-1][10:] == ["0"]  # neither jitter nor latency
    assert [row[0] for row in categories] == ["category", "kerbs", "over_exposure", "total"]
    assert page.texts("div", "tile")[0].startswith("0.875paper's precision")


def test_the_literatures_measures(page, results):
    (table,) = (table for table in page.tables if "TuSimpleaccuracy" in table[0])
    total = by_sequence(results)["total"]
    measures = total.tusimple.accuracy, total.tusimple.fp, total.tusimple.fn, total.culane.f1
    assert table[-1][1:5] == [f"{value:.3f}" for value in measures]
    assert table[-1][5:] == [str(n) for n in (total.culane.tp, total.culane.fp, total.culane.fn)]


def test_depth_and_3d(page, results):
    (table,) = (table for table in page.tables if "3-D m6-12 m" in table[0])
    total = summarise(results).in_space
    assert table[0] == ["sequence", "3-D m6-12 m", "3-D m12-25 m", "3-D mat 10 m", "3-D mat 25 m"]
    values = (mean.value for mean in (total.near, total.far, total.at_10, total.at_25))
    assert table[-1] == ["total", *(f"{value:.3f}" for value in values)]
    assert total.near.value == pytest.approx(0.05 / 9)  # one of nine lines is 0.05 m aside


def test_the_page_of_the_surface_alone(tmp_path):
    errors = DepthErrors((0.02,) * len(CURVE_DEPTHS))
    scores = [
        FrameScore("<b>/0", "<b>", "", None, (), depth=errors),
        FrameScore("c/0", "c", "", None, (), depth=NO_SURFACE),
    ]
    path = write_surface_report(scores, tmp_path / "a <b>&", tmp_path / "report")
    parsed = Parsed(path.read_text(encoding="utf-8"))
    assert_by_itself(parsed)
    assert parsed.texts("h1") == ["Road surface judged by LiDAR: a <b>&"]
    table, frames = parsed.tables
    assert table[1:] == [
        ["<b>", *["+2.00", "2.00"] * 4, "0"],
        ["c", *["-"] * 8, "1"],
        ["total", *["+2.00", "2.00"] * 4, "1"],
    ]
    assert [row[0] for row in frames[1:]] == ["c/0", "<b>/0"] and parsed.count("svg", "chart") == 1
    assert write_surface_report(scores, tmp_path, tmp_path / "report") == path  # replaced by its like
    (tmp_path / "other").mkdir()
    (tmp_path / "other/index.html").write_text("<p>mine</p>")
    with pytest.raises(CommandError, match="exists already and is no report"):
        write_surface_report(scores, tmp_path, tmp_path / "other")


def test_failures_are_classed(page):
    (table,) = (table for table in page.tables if table[0][0] == "class")
    assert table[1:] == [
        ["over-exposure", "1", "1", "·", "·"],
        ["similar objects", "·", "·", "1", "1"],
        ["not known", "·", "1", "·", "·"],
    ]


def test_curves(page):
    assert page.count("svg", "chart") == 3
    assert page.count("circle", "point") == 4  # bins of confidence with lines in them


def test_the_worst_frame_comes_first_and_says_what_is_wrong(page):
    cards = page.texts("article", "frame")
    assert [card.split()[1][:9] for card in cards] == ["drive/<b>", "drive/bli", "drive/pla", "drive/fin"]
    assert "1 false" in cards[0] and "1 duplicate" in cards[0] and "0.65 ego right 7" in cards[0]
    assert "false (similar objects)" in cards[0]
    assert "L solid, ego left: missed (over-exposure)" in cards[1]
    assert "LL solid: not found" in cards[2] and "not known" not in cards[2]
    assert "no failure" in cards[3] and "R solid, ego right: found, 0.0 cm off" in cards[3]
    assert page.texts("b", "tag")[:2] == ["0.65", "0.35"]


def test_a_bag_without_images_shows_a_drawing_and_says_so(page):
    assert page.texts("p", "note") == ["no images: the bag has none of this frame"] * 4
    assert page.count("figure", "plan") == 4 and page.count("img", "") == 0
    assert page.count("polyline", "label missed") == 2  # with its casing
    assert page.count("polyline", "lane false") == 2


def test_road_edges_and_kinds_of_paint(tmp_path, frames, results, empty_bag):
    left, right, other = frames[0].labels
    labels = left, replace(right, kind="edge", sure=True), replace(other, kind="edge")
    frame = replace(frames[0], labels=labels, ego_right=None)
    found = [detection.lane for detection in results[0].detections]
    on_left, on_right, _ = found
    astray = replace(on_right, points=on_right.points + np.array([2.0, 0, 0]))
    told = replace(on_left, kind="dashed", colour="white")
    result = judge(frame, [told, on_right], CAMERA, road_edges=[on_right, astray])
    page = Parsed(write_report([result], empty_bag, tmp_path / "r").read_text(encoding="utf-8"))
    edges = next(table for table in page.tables if "road edgeslabelled" in table[0])
    assert edges[-1][1:7] == ["2", "1", "0.500", "2", "1", "1.00"]
    kinds = next(table for table in page.tables if table[0][0] == "kind")
    assert kinds[1:] == [["solid", "0", "1", "0.000"], ["total", "0", "1", "0.000"]]
    (card,) = page.texts("article", "frame")
    assert "R edge: found, 0.0 cm off" in card and "LL edge: not found" in card
    assert "right, it is R, 5 to 28 m" in card and "false, 5 to 28 m" in card
    assert "strictly false, it runs along an unpainted edge" in card
    assert page.count("polyline", "road-edge right") == 1
    assert page.count("polyline", "road-edge false") == 2  # with its casing
    assert "#cc4de6" in "".join(page.texts("style"))


def scene_score(pair, name):
    """Return the result of a detector that misses the last line of a rendered pair."""
    frame = replace(pair.truth, name=name, sequence="scene", category="curve")
    lanes = LaneDetector(CAMERA, preset("default")).detect(StereoFrame(pair.left, pair.right)).lanes
    return judge(frame, lanes[:-1], CAMERA)


def test_pictures_of_a_bag(tmp_path, scene_pairs, write_stereo_bag):
    results = [scene_score(pair, f"s/{i}") for i, pair in enumerate(scene_pairs[:2])]
    path = write_report(results, write_stereo_bag(scene_pairs), tmp_path / "report")
    parsed = Parsed(path.read_text(encoding="utf-8"))
    assert_by_itself(parsed)
    assert parsed.count("article", "frame") == 2 and parsed.count("p", "note") == 0
    titles = parsed.texts("figcaption")[3:6]
    assert titles[:2] == ["Left image", "From above"] and re.fullmatch(r"Cost, \d+ paths?", titles[2])
    assert parsed.count("polyline", "path") >= 2
    images = [jpeg(attributes["src"]) for tag, attributes, _ in parsed.all if tag == "img"]
    assert [image.shape[:2] for image in images[:3]] == [(375, 1242), (600, 320), (600, 320)]
    shown = [np.mean(cv2.absdiff(images[0], pair.left)) for pair in scene_pairs[:2]]
    assert min(shown) < 4 and max(shown) > 8  # it is one of them, as JPEG
    assert path.stat().st_size < 2 * 400_000


def test_lines_lie_on_the_paint_from_above(tmp_path, scene_pairs, write_stereo_bag):
    result = scene_score(scene_pairs[0], "s/0")
    page = write_report([result], write_stereo_bag(scene_pairs[:1]), tmp_path / "report")
    parsed = Parsed(page.read_text(encoding="utf-8"))
    above = cv2.cvtColor(jpeg([a["src"] for tag, a, _ in parsed.all if tag == "img"][1]), cv2.COLOR_BGR2GRAY)
    # In the second figure of the card; the view is 15 m wide, 20 px to the metre.
    html = page.read_text(encoding="utf-8").split('<figure class="above"')[1].split("</figure>")[0]
    lines = re.findall(r'<polyline class="lane right" points="([^"]+)"', html)
    lanes = [detection.lane for detection in result.detections]
    assert len(lines) == len(lanes) > 0
    for line, lane in zip(lines, lanes, strict=True):
        xy = 20 * np.array([pair.split(",") for pair in line.split()], dtype=float)
        np.testing.assert_allclose(xy[[0, -1], 1], 20 * (34 - np.array(lane.extent)), atol=10)  # 4 to 34 m
        column, row = np.clip(np.rint(xy).astype(int), 8, (291, 599)).T
        beside = np.maximum(above[row, column - 8], above[row, column + 8]).astype(float)
        assert np.mean(above[row, column] > beside + 20) > 0.3  # dashes are a third of their line


def test_pictures_of_a_folder(tmp_path, scene_pairs):
    cv2.imwrite(str(tmp_path / "l.png"), scene_pairs[0].left)
    cv2.imwrite(str(tmp_path / "r.png"), scene_pairs[0].right)
    pair = replace(scene_pairs[0].truth, name="s/0", stamp_ns=None, left="l.png", right="r.png")
    save_truth([pair], tmp_path / "t.json")
    arguments = [
        "evaluate",
        tmp_path,
        "--truth",
        tmp_path / "t.json",
        "--report",
        tmp_path / "out",
        "--jobs",
        "1",
    ]
    assert main([*map(str, arguments)]) == 0
    parsed = Parsed((tmp_path / "out/index.html").read_text(encoding="utf-8"))
    assert parsed.count("img", "") == 3


def test_the_overlay_of_an_offline_run_is_shown(tmp_path, results):
    with BagWriter(tmp_path / "run") as writer:
        header = bag_message("std_msgs/msg/Header", stamp=stamp_to_ros(2, bag_message))
        image = image_to_ros(np.full((375, 1242, 3), 90, np.uint8), header, bag_message)
        writer.write("/car/overlay/image", 2, image)
    page = write_report(results, tmp_path / "run", tmp_path / "report").read_text(encoding="utf-8")
    parsed = Parsed(page)
    assert parsed.count("img", "") == 1 and parsed.count("figure", "plan") == 4
    assert [note[:32] for note in parsed.texts("p", "note")][1] == "the bag has no stereo pairs: the"
    assert "not found LL" in parsed.texts("article", "frame")[1]


def test_a_road_without_paint_has_no_labels(tmp_path, scene_pairs, write_stereo_bag):
    bag = write_stereo_bag(scene_pairs)
    assert main(["evaluate", str(bag), "--unpainted", "--report", str(tmp_path / "out"), "--jobs", "1"]) == 0
    parsed = Parsed((tmp_path / "out/index.html").read_text(encoding="utf-8"))
    assert parsed.count("article", "frame") == 3 and parsed.count("img", "") == 9
    assert "this road is known to have no paint" in parsed.texts("article", "frame")[0]
    assert parsed.count("polyline", "lane false") > 0 and parsed.count("polyline", "label") == 0


def test_not_more_than_thirty_frames_are_shown(tmp_path, make_labelled, empty_bag):
    frames = [make_labelled(f"drive/{i}", stamp_ns=i) for i in range(40)]
    results = [judge(frame, (), CAMERA) for frame in frames]
    page = write_report(results, empty_bag, tmp_path / "report").read_text(encoding="utf-8")
    assert Parsed(page).count("article", "frame") == 30
    assert "40 of 40 frames have a failure; these are the 30 worst." in page


def test_no_frames(tmp_path, empty_bag):
    page = Parsed(write_report([], empty_bag, tmp_path / "report").read_text(encoding="utf-8"))
    assert "No frame was judged." in page.texts("main")[0]


def test_lines_that_leave_the_image_are_cut(tmp_path, frames, empty_bag):
    """A label beyond the picture and one with a point at infinity draw nothing that is not a number."""
    far = Label(
        "far", "solid", True, np.array([[-9000.0, 400], [-8000, 380]]), np.array([[-90.0, 6], [-90, 9]])
    )
    frame = replace(frames[0], labels=(*frames[0].labels, far))
    page = write_report([judge(frame, (), CAMERA)], empty_bag, tmp_path / "r").read_text(encoding="utf-8")
    assert "nan" not in page.split('id="gallery"')[1] and "-9000" not in page


def test_a_report_replaces_a_report_and_nothing_else(tmp_path, results, empty_bag):
    page = write_report(results, empty_bag, tmp_path / "report")
    first = page.read_bytes()
    assert write_report(results, empty_bag, tmp_path / "report").read_bytes() == first
    assert [each.name for each in page.parent.iterdir()] == ["index.html"]
    page.write_text("my homepage", encoding="utf-8")
    with pytest.raises(
        CommandError, match=r"index.html exists already and is no report: choose another folder"
    ):
        write_report(results, empty_bag, page.parent)
    assert page.read_text(encoding="utf-8") == "my homepage"
    with pytest.raises(CommandError, match="index.html is no folder: --report takes the name of one"):
        write_report(results, empty_bag, page)


def test_a_folder_that_cannot_be_written(results, empty_bag):
    with pytest.raises(CommandError, match=r"cannot write /proc/report/index.html: "):
        write_report(results, empty_bag, type(empty_bag)("/proc/report"))


def test_pictures_stay_small():
    noise = np.random.default_rng(0).integers(0, 256, (1000, 1242, 3), dtype=np.uint8)
    uri = data_uri(noise, LEFT_BYTES)
    assert len(uri) < 4 / 3 * LEFT_BYTES + 100
    assert jpeg(uri).shape == (500, 621, 3)  # noise does not fit: halved


def jpeg(uri):
    data = base64.b64decode(uri.removeprefix("data:image/jpeg;base64,"), validate=True)
    image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
    assert image is not None
    return image


def test_where_labels_were_lost(tmp_path, scene_pairs, write_stereo_bag):
    """The detector finds all in the pair; the line that the results lack was lost after it."""
    result = scene_score(scene_pairs[0], "s/0")
    page = write_report([result], write_stereo_bag(scene_pairs[:1]), tmp_path / "report")
    parsed = Parsed(page.read_text(encoding="utf-8"))
    (stages,) = (table for table in parsed.tables if table[0][0] == "stage")
    assert [row[0] for row in stages[1:]] == ["found in the pair alone"]
    (worst,) = (table for table in parsed.tables if table[0][0] == "frame")
    assert worst[0] == ["frame", "failures", "the gravest", "category"]
    assert worst[1][2].endswith(": these parameters find it in this pair by itself")


def test_a_page_without_failures_says_so(tmp_path, results, empty_bag):
    page = Parsed(write_report(results[:1], empty_bag, tmp_path / "r").read_text(encoding="utf-8"))
    (failures,) = page.texts("section", "")[1:2]
    assert "None: every line was found, and none that is not there." in failures
    assert not [table for table in page.tables if table[0][0] in ("frame", "stage", "class")]


def test_a_comparison_finds_the_images_again(tmp_path, scene_pairs):
    """Of a folder that was judged, unless it is gone; then another one may be named."""
    (tmp_path / "here").mkdir()
    pair = scene_pairs[0]
    for name, image in (("l.png", pair.left), ("r.png", pair.right)):
        cv2.imwrite(str(tmp_path / "here" / name), image)
    frame = replace(pair.truth, name="s/0", stamp_ns=None, left="l.png", right="r.png")
    save_truth([frame], tmp_path / "t.json")

    def run(*arguments):
        assert main(["evaluate", *map(str, arguments), "--jobs", "1"]) == 0

    run(tmp_path / "here", "--truth", tmp_path / "t.json", "--json", tmp_path / "A.json")
    result = read_json(tmp_path / "A.json").results[0]
    nothing = judge(result.truth, (), CAMERA)
    write_json([nothing], (), tmp_path / "B.json", tmp_path / "here")
    compared = "--compare", tmp_path / "A.json", tmp_path / "B.json", "--report", tmp_path / "page"
    run(*compared)
    parsed = Parsed((tmp_path / "page/index.html").read_text(encoding="utf-8"))
    assert_by_itself(parsed)
    assert parsed.count("img", "") == 2 and parsed.texts("figcaption")[-2:] == ["A", "B"]
    (tmp_path / "here").rename(tmp_path / "there")
    run(*compared)
    parsed = Parsed((tmp_path / "page/index.html").read_text(encoding="utf-8"))
    assert parsed.count("img", "") == 0 and parsed.count("figure", "plan") == 2
    (note,) = parsed.texts("p", "note")
    assert note == f"no images: {tmp_path}/here is not there; name the bag or folder before --compare"
    run(tmp_path / "there", *compared)
    assert '<img src="data:image/jpeg' in (tmp_path / "page/index.html").read_text(encoding="utf-8")
