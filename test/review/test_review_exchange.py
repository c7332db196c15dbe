# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Lines to annotation tools and back: COCO's JSON and CVAT's XML, ours and other people's."""

import json
import zipfile
from dataclasses import replace
from xml.etree import ElementTree

import cv2
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from lane_dp_ros.review.exchange import FORMATS, frame_name, lines_as_text, lines_from_text
from lane_dp_ros.review.judgement import ROLES, Line
from lane_dp_ros.review.lines_as_truth import detected_lines
from lane_dp_ros.review.read_drive import read_drive
from lane_dp_ros.tools.cli import main
from lane_dp_ros.tools.evaluation.truth_file import KINDS


@pytest.fixture
def drive(drive_bag):
    return read_drive(drive_bag, drive_bag)


@pytest.fixture
def detected(drive):
    return {frame.index: detected_lines(frame) for frame in drive.frames}


def cvat(shapes: str, name: str = "drive/000001.jpg", size: str = 'width="400" height="200"') -> str:
    return f'<annotations><image id="7" name="{name}" {size}>{shapes}</image></annotations>'


def coco(**changes) -> str:
    """One image with one annotation; `changes` are those of its fields."""
    annotation = {"id": 1, "image_id": 5, "category_id": 2, "segmentation": [[100, 180, 150, 90]]} | changes
    content = {
        "images": [{"id": 5, "file_name": "000001.png", "width": 400, "height": 200}],
        "categories": [{"id": 2, "name": "lane"}],
        "annotations": [annotation],
    }
    return json.dumps(content)


@pytest.mark.parametrize("form", FORMATS)
def test_detected_lines_come_back_as_they_are(drive, detected, form):
    text = lines_as_text(drive, detected, form)
    assert lines_from_text(drive, text) == (detected, 0)
    assert lines_from_text(drive, "\ufeff" + text) == (detected, 0)


POINTS = st.tuples(st.integers(0, 3999), st.integers(0, 1999)).map(lambda p: (p[0] / 10, p[1] / 10))
LINES = st.builds(
    Line,
    st.text(st.characters(min_codepoint=33, max_codepoint=0x2FF), min_size=1, max_size=40),
    st.sampled_from(ROLES),
    st.sampled_from(KINDS),
    st.booleans(),
    # From near to far, as detected lines are.
    st.lists(POINTS, min_size=2, max_size=6).map(lambda uv: tuple(sorted(uv, key=lambda p: -p[1]))),
)


def could_be_of_one_frame(lines) -> bool:
    egos = [line.role for line in lines if line.role != "other"]
    return len(set(egos)) == len(egos) and len({line.id for line in lines}) == len(lines)


@pytest.mark.parametrize("form", FORMATS)
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=50)
@given(lines=st.lists(LINES, max_size=5).filter(could_be_of_one_frame))
def test_lines_of_every_kind_come_back(drive, form, lines):
    found, _ = lines_from_text(drive, lines_as_text(drive, {1: tuple(lines)}, form))
    assert found == {1: tuple(lines)}


def test_cvat_as_cvat_writes_it(drive, detected):
    root = ElementTree.fromstring(lines_as_text(drive, detected, "cvat"))
    assert (root.tag, root.findtext("version"), root.findtext("meta/task/size")) == (
        "annotations",
        "1.1",
        "5",
    )
    labels = {label.findtext("name"): label for label in root.iter("label")}
    assert list(labels) == ["ego_left", "ego_right", "other"]
    assert {label.findtext("type") for label in labels.values()} == {"polyline"}
    kind = next(a for a in labels["other"].iter("attribute") if a.findtext("name") == "kind")
    assert (kind.findtext("input_type"), kind.findtext("values")) == ("select", "solid\ndashed\nedge")
    image = root.findall("image")[0]
    assert image.attrib == {"id": "0", "name": "drive/000000.jpg", "width": "400", "height": "200"}
    # At 4 m the line 1.8 m left of the camera is at u = 109.5, v = 135; from a corner half a px more.
    assert image.find("polyline").get("points").split(";")[0] == "110.00,135.50"
    assert {a.get("name"): a.text for a in image.find("polyline")} == {
        "kind": "solid", "sure": "true", "id": "7",
    }  # fmt: skip


def test_coco_as_its_readers_expect_it(drive, detected):
    content = json.loads(lines_as_text(drive, detected, "coco"))
    assert [image["file_name"] for image in content["images"]] == [f"drive/{i:06d}.jpg" for i in range(5)]
    names = {each["id"]: each["name"] for each in content["categories"]}
    first = content["annotations"][0]
    assert (first["image_id"], names[first["category_id"]]) == (1, "ego_left")
    assert first["keypoints"][:3] == [110.0, 135.5, 2]
    assert first["segmentation"][0][:2] == [110.0, 135.5]
    assert len(first["keypoints"]) == 3 * first["num_keypoints"]
    x, y, width, height = first["bbox"]
    assert (x, y + height) == (110.0, 135.5) and width > 0
    assert len({each["id"] for each in content["annotations"]}) == len(content["annotations"]) == 8


def test_other_peoples_cvat(drive):
    """Any label, no attributes, drawn from far to near: the nearest ones on both sides are the ego lines."""
    shapes = (
        '<polyline label="lane" source="manual" occluded="0" points="180.5,80.5;50.5,180.5" z_order="0"/>'
        '<polyline label="lane" points="350.5,190.5;220.5,80.5"/>'
        '<polyline label="dashed" points="20.5,120.5;150.5,80.5"/>'
        '<box label="car" xtl="1" ytl="2" xbr="3" ybr="4"/><tag label="rain"/>'
    )
    found, left_out = lines_from_text(drive, cvat(shapes, name="images/000001.png"))
    assert left_out == 1
    left, right, other = found[1]
    assert (left.role, left.kind, left.sure, left.uv) == ("ego_left", "solid", True, ((50, 180), (180, 80)))
    assert (right.role, other.role, other.kind) == ("ego_right", "other", "dashed")
    assert len({line.id for line in found[1]}) == 3


def test_a_line_that_was_copied_in_the_tool_gets_an_id_of_its_own(drive):
    shape = '<polyline label="other" points="1,150;2,90"><attribute name="id">{}</attribute></polyline>'
    found, _ = lines_from_text(drive, cvat("".join(shape.format(name) for name in ("5", "5", "a0"))))
    assert [line.id for line in found[1]] == ["5", "a1", "a0"]


def test_other_peoples_coco(drive):
    """Several parts are several lines; keypoints go before them, and those that are not visible are none."""
    found, _ = lines_from_text(
        drive, coco(segmentation=[[10.5, 180.5, 50.5, 90.5], [300.5, 180.5, 250.5, 90.5]])
    )
    assert [(line.role, line.uv[0]) for line in found[1]] == [
        ("ego_left", (10, 180)),
        ("ego_right", (300, 180)),
    ]
    found, _ = lines_from_text(drive, coco(keypoints=[1.5, 180.5, 2, 0, 0, 0, 9.5, 90.5, 1], segmentation=[]))
    assert found[1][0].uv == ((1, 180), (9, 90))
    assert lines_from_text(drive, coco(segmentation=[], bbox=[1, 2, 3, 4])) == ({1: ()}, 1)


LINE = '<polyline label="lane" points="{}"/>'


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "no whole JSON"),
        ("[" * 100_000, "the JSON is too deep"),
        ("[]", "the JSON is [], expected an object as COCO has it"),
        ("{}", "images is None, expected a list of objects"),
        ('{"images": [], "categories": [], "annotations": []}', "there are no images"),
        ('{"images": ' + "9" * 5000 + "}", "no whole JSON"),
        (coco(image_id=9), "annotation 1: image_id is 9, which no image has"),
        (coco(image_id=[9]), "an id is [9], expected a whole number"),
        (coco(category_id=9), "image '000001.png', annotation 1: category_id is 9, which no category has"),
        (coco(segmentation={"counts": "a"}), "expected lists of x, y (no mask)"),
        (coco(segmentation=[[1, 2, 3]]), "segmentation has 3 numbers, expected x and y of two points"),
        (coco(segmentation=[[1, 2, None, 4]]), "segmentation holds None, expected a finite number"),
        (coco(segmentation=[[1, 2, True, 4]]), "segmentation holds True, expected a finite number"),
        (coco(segmentation=[[1, 2, 10**400, 4]]), "segmentation holds 1000"),
        (coco(segmentation=[[1, 2, float("nan"), 4]]), "segmentation holds nan, expected a finite number"),
        (coco(segmentation=[[1, 2, 9e9, 4]]), "has the point 9e+09, 4, far outside of the 400x200 image"),
        (coco(keypoints=[1, 2]), "keypoints is [1, 2], expected x, y, visible of each point"),
        (coco(attributes=[]), "attributes is [], expected an object"),
        (coco(attributes={"kind": "wavy"}), "'000001.png': kind is 'wavy', expected one of solid"),
        (coco().replace("400", "640"), "image '000001.png' is 640x200, its frame 400x200"),
        (coco().replace("400", "1e9"), "image '000001.png': width is 1000000000.0, expected a whole number"),
        (coco().replace("000001.png", "other.png"), "'other.png' is no frame: expected drive/000000.jpg"),
        (coco().replace("000001.png", "000005.png"), "'000005.png' is no frame: expected drive/000000.jpg"),
        ("<annotations>", "no whole XML"),
        ("<a/>", "the XML is <a>, expected <annotations> of CVAT for images"),
        ("<annotations/>", "there are no images"),
        ('<annotations><track id="0"/></annotations>', "CVAT for video (<track>), expected an export as"),
        ('<!DOCTYPE a [<!ENTITY b "bb">]><annotations>&b;</annotations>', "declares a document type"),
        (cvat("", name=""), "<image> 1 has no name"),
        (cvat("", size='width="400"'), "'drive/000001.jpg': height holds None, expected a finite"),
        (cvat(LINE.format("")), "image 'drive/000001.jpg', polyline 1: points is '', expected x,y;x,y;..."),
        (cvat(LINE.format("1,2")), "polyline 1: points has 2 numbers, expected x and y of two points"),
        (cvat(LINE.format("1,2;3,x")), "polyline 1: points holds 'x', expected a finite number"),
        (cvat(LINE.format("1,2;3,inf")), "polyline 1: points holds 'inf', expected a finite number"),
        (cvat(2 * LINE.format("1,2;3,4").replace("lane", "ego_left")), "two lines have one role: ego_left"),
        (cvat(51 * LINE.format("1,2;3,4")), "image 'drive/000001.jpg': lines are"),
    ],
)  # fmt: skip
def test_what_cannot_be_taken_in_is_said_in_one_line(drive, text, said):
    with pytest.raises(ValueError) as refused:  # noqa: PT011 - the message is looked at below
        lines_from_text(drive, text)
    assert said in str(refused.value)
    assert len(str(refused.value)) < 300 and "\n" not in str(refused.value)


def test_two_images_of_one_frame(drive, detected):
    text = lines_as_text(drive, detected, "cvat").replace("drive/000003.jpg", "b/000001.png")
    with pytest.raises(ValueError, match="image 'b/000001.png' is frame 2, as one before it"):
        lines_from_text(drive, text)


def test_another_format(drive, detected):
    with pytest.raises(ValueError, match="format is 'yolo', expected one of coco, cvat"):
        lines_as_text(drive, detected, "yolo")


@pytest.mark.parametrize("ending", FORMATS.values())
def test_out_by_the_command_and_in_again(drive, drive_bag, tmp_path, capsys, ending):
    def review(*options) -> str:
        assert main(["review", str(drive_bag), *map(str, options)]) == 0
        return capsys.readouterr().out.splitlines()[-1]

    path, again = tmp_path / f"lines{ending}", tmp_path / f"again{ending}"
    assert review("--export", path) == f"{path}: lines of 5 frames"
    assert review("--import", path) == f"{path}: 5 images, lines of 0 frames changed"
    file = drive_bag.with_name(f"{drive_bag.name}.review.json")
    assert not file.exists()  # nothing was said that is not so without it
    path.write_text(path.read_text().replace("110", "112"))
    assert review("--import", path, "--export", again) == f"{again}: lines of 5 frames"
    assert lines_from_text(drive, again.read_text()) == lines_from_text(drive, path.read_text())
    judged = json.loads(file.read_text())["judgements"]
    assert all(each["lines"][0]["uv"][0][0] == 111.5 for each in judged.values())
    assert review("--import", path) == f"{path}: 5 images, lines of 0 frames changed"


def test_files_that_cannot_be_read_or_written(drive_bag, tmp_path, refused):
    (binary := tmp_path / "binary.json").write_bytes(b"\xff\xfe\x00")
    (wrong := tmp_path / "wrong.xml").write_text(cvat(LINE.format("1,2;3,x")))
    assert refused(drive_bag, "--import", tmp_path / "no.json").endswith(
        "No such file or directory: " + repr(str(tmp_path / "no.json"))
    )
    assert f"{binary} is no text (UTF-8): expected COCO's" in refused(drive_bag, "--import", binary)
    assert "expected a name that ends in .json, .xml, .zip" in refused(
        drive_bag, "--export", tmp_path / "lines.txt"
    )
    assert refused(drive_bag, "--export", wrong) == f"lane_dp: {wrong} exists already: choose another name"


def test_an_archive_for_cvat_has_the_pictures(drive, drive_bag, tmp_path, capsys):
    path = tmp_path / "lines.zip"
    assert main(["review", str(drive_bag), "--export", str(path)]) == 0
    with zipfile.ZipFile(path) as archive:
        names = [f"images/drive/{index:06d}.jpg" for index in range(5)]
        assert archive.namelist() == ["annotations.xml", *names]
        picture = cv2.imdecode(np.frombuffer(archive.read(names[2]), np.uint8), cv2.IMREAD_UNCHANGED)
    np.testing.assert_allclose(picture, drive.image(drive.frames[2]), atol=3)
    assert main(["review", str(drive_bag), "--import", str(path)]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == f"{path}: 5 images, lines of 0 frames changed"


@pytest.mark.parametrize(
    ("members", "said"),
    [
        ({}, "expected one file of annotations (.xml, .json) in it, it has none"),
        ({"a.xml": "", "b/c.json": "{}"}, "in it, it has a.xml, b/c.json"),
        ({"a.xml": b"\xff"}, "is no text (UTF-8)"),
    ],
)
def test_archives_without_annotations(drive_bag, tmp_path, refused, members, said):
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    assert said in refused(drive_bag, "--import", tmp_path / "a.zip")


def test_an_archive_that_is_damaged(drive_bag, tmp_path, refused):
    with zipfile.ZipFile(path := tmp_path / "a.zip", "w") as archive:
        archive.writestr("a.xml", "<annotations/>" * 50)
    path.write_bytes(path.read_bytes().replace(b"<annotations/>", b"<annotationz/>", 1))
    assert f"cannot read {path}: Bad CRC-32" in refused(drive_bag, "--import", path)


def test_a_wrong_file_is_named_and_changes_nothing(drive_bag, tmp_path, capsys):
    (wrong := tmp_path / "wrong.xml").write_text(cvat(LINE.format("1,2;3,x")))
    assert main(["review", str(drive_bag), "--import", str(wrong)]) == 1
    said = (
        f"lane_dp: {wrong}: image 'drive/000001.jpg', polyline 1: points holds 'x', expected a finite number"
    )
    assert capsys.readouterr().err.splitlines() == [said]
    assert not drive_bag.with_name(f"{drive_bag.name}.review.json").exists()


def test_a_frames_name_is_that_of_the_truth(drive):
    assert frame_name(drive, drive.frames[3]) == "drive/000003.jpg"
    assert frame_name(replace(drive, bag=drive.bag.with_name("b.mcap")), drive.frames[0]) == "b/000000.jpg"
