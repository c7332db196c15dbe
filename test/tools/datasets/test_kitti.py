# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""KITTI folders become bags; what is missing in a folder is named in one line."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from lane_dp_ros.messages.bag import BagReader, BagWriter
from lane_dp_ros.messages.camera import camera_from_ros
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.image import compressed_image_from_ros, image_from_ros
from lane_dp_ros.tools.datasets.convert import convert
from lane_dp_ros.tools.datasets.kitti import (
    LAYOUTS,
    StereoSequence,
    load_pairs,
    read_odometry,
    read_raw,
    read_stereo,
)

GRAY_LEFT = "700 0 20 0 0 700 10 0 0 0 1 0"
GRAY_RIGHT = "700 0 20 -378 0 700 10 0 0 0 1 0"
COLOUR_LEFT = "700 0 20 42 0 700 10 -0.11 0 0 1 0.004"
COLOUR_RIGHT = "700 0 20 -336 0 700 10 2.4 0 0 1 0.005"
NAMES = ("000000.png", "000001.png", "000002.png")


def write_images(folder: Path, names: tuple[str, ...] = NAMES, colour: bool = False, offset: int = 0) -> None:
    folder.mkdir(parents=True)
    for index, name in enumerate(names):
        pixels = np.arange(20 * 40, dtype=np.uint8).reshape(20, 40) + np.uint8(10 * index + offset)
        cv2.imwrite(str(folder / name), np.dstack([pixels, pixels + 1, pixels + 2]) if colour else pixels)


def odometry(root: Path, colour: bool = False) -> Path:
    folder = root / "sequences/07"
    for camera in (2, 3) if colour else (0, 1):
        write_images(folder / f"image_{camera}", colour=colour, offset=100 * (camera % 2))
    lines = {"P0": GRAY_LEFT, "P1": GRAY_RIGHT, "P2": COLOUR_LEFT, "P3": COLOUR_RIGHT}
    (folder / "calib.txt").write_text("".join(f"{name}: {P}\n" for name, P in lines.items()))
    (folder / "times.txt").write_text("0.000000e+00\n1.036117e-01\n2.073529e-01\n")
    return folder


def raw(root: Path) -> Path:
    folder = root / "2011_09_26/2011_09_26_drive_0027_sync"
    for camera in ("image_02", "image_03"):
        write_images(folder / camera / "data", colour=True)
        stamps = "2011-09-26 13:02:25.964389445\n2011-09-26 13:02:26.064\n2011-09-26 13:02:26.174389445\n"
        (folder / camera / "timestamps.txt").write_text(stamps)
    text = f"calib_time: 09-Jan-2012 13:57:47\nP_rect_02: {COLOUR_LEFT}\nP_rect_03: {COLOUR_RIGHT}\n"
    (folder.parent / "calib_cam_to_cam.txt").write_text(text)
    return folder


def stereo(root: Path) -> Path:
    names = ("000003_10.png", "000003_11.png", "000009_10.png")
    for camera in (2, 3):
        write_images(root / f"image_{camera}", names, colour=True)
    (root / "calib_cam_to_cam.txt").write_text(f"P_rect_02: {COLOUR_LEFT}\nP_rect_03: {COLOUR_RIGHT}\n")
    return root


def converted(sequence: StereoSequence, path: Path, jpeg: bool = False) -> dict[str, list]:
    with BagWriter(path) as writer:
        convert(sequence, writer, jpeg)
    with BagReader(path) as reader:
        messages: dict[str, list] = {}
        for topic, _, message in reader.messages():
            messages.setdefault(topic, []).append(message)
    return messages


def test_gray_odometry(tmp_path: Path) -> None:
    folder = odometry(tmp_path)
    sequence = read_odometry(folder)
    assert sequence.stamps_ns == [0, 103611700, 207352900]
    messages = converted(sequence, tmp_path / "bag")
    topics = {f"/{side}/{name}" for side in ("left", "right") for name in ("image_rect", "camera_info")}
    assert messages.keys() == topics | {"/tf_static"}
    (poses,) = messages.pop("/tf_static")
    (pose,) = poses.transforms
    assert (pose.header.frame_id, pose.transform.translation.z) == ("base_link", 1.65)
    assert pose.child_frame_id == messages["/left/image_rect"][0].header.frame_id
    turned = pose.transform.rotation
    assert (turned.x, turned.y, turned.z, turned.w) == (-0.5, 0.5, -0.5, 0.5)  # REP 103
    assert all(len(of_topic) == 3 for of_topic in messages.values())
    for side, camera in (("left", 0), ("right", 1)):
        for index, message in enumerate(messages[f"/{side}/image_rect"]):
            written = cv2.imread(str(folder / f"image_{camera}" / NAMES[index]), cv2.IMREAD_UNCHANGED)
            np.testing.assert_array_equal(image_from_ros(message), written)
            assert message.encoding == "mono8"
            assert message.header.stamp.nanosec == sequence.stamps_ns[index]


def test_colour_odometry_keeps_both_offsets(tmp_path: Path) -> None:
    messages = converted(read_odometry(odometry(tmp_path, colour=True)), tmp_path / "bag")
    left, right = (messages[f"/{side}/camera_info"][0] for side in ("left", "right"))
    np.testing.assert_array_equal(left.p, [float(value) for value in COLOUR_LEFT.split()])
    np.testing.assert_array_equal(right.p, [float(value) for value in COLOUR_RIGHT.split()])
    assert camera_from_ros(left, right).baseline == pytest.approx(0.54)
    assert (left.width, left.height) == (40, 20)
    assert left.header.frame_id == right.header.frame_id != ""
    np.testing.assert_array_equal(left.k, [700, 0, 20, 0, 700, 10, 0, 0, 1])
    assert messages["/left/image_rect"][0].encoding == "bgr8"


def test_jpeg_goes_to_the_compressed_topics(tmp_path: Path) -> None:
    folder = odometry(tmp_path, colour=True)
    messages = converted(read_odometry(folder), tmp_path / "bag", jpeg=True)
    assert "/left/image_rect" not in messages
    message = messages["/right/image_rect/compressed"][1]
    assert message.format == "bgr8; jpeg compressed bgr8"
    written = cv2.imread(str(folder / "image_3" / NAMES[1]))
    difference = np.abs(compressed_image_from_ros(message).astype(int) - written)
    assert difference.mean() < 10


def test_raw_drive_with_its_calibration_in_the_parent(tmp_path: Path) -> None:
    sequence = read_raw(raw(tmp_path))
    midnight_utc = 1316995200 * 10**9  # 2011-09-26
    seconds = 13 * 3600 + 2 * 60 + 25
    assert sequence.stamps_ns[0] == midnight_utc + seconds * 10**9 + 964389445
    assert sequence.stamps_ns[1] == midnight_utc + (seconds + 1) * 10**9 + 64000000
    assert sequence.P_left[0, 3] == 42
    assert len(converted(sequence, tmp_path / "bag")["/left/image_rect"]) == 3


def test_single_pairs_are_too_far_apart_to_be_tracked(tmp_path: Path) -> None:
    sequence = read_stereo(stereo(tmp_path))
    assert [path.name for path in sequence.left] == ["000003_10.png", "000009_10.png"]
    assert np.diff(sequence.stamps_ns).min() > 10**9


def test_a_part_of_a_sequence_keeps_its_times(tmp_path: Path) -> None:
    folder = odometry(tmp_path)
    for camera in (0, 1):
        (folder / f"image_{camera}" / NAMES[0]).unlink()
    assert read_odometry(folder).stamps_ns == [103611700, 207352900]


@pytest.mark.parametrize("layout", LAYOUTS)
def test_a_folder_of_another_kind(tmp_path: Path, layout: str) -> None:
    with pytest.raises(CommandError, match=r"has no stereo images: looked for .*image_"):
        LAYOUTS[layout](tmp_path)
    with pytest.raises(CommandError, match="no such folder"):
        LAYOUTS[layout](tmp_path / "none")


def test_a_folder_without_images(tmp_path: Path) -> None:
    folder = odometry(tmp_path)
    for image in folder.glob("image_*/*.png"):
        image.unlink()
    with pytest.raises(CommandError, match=r"no images: looked for .*image_0/\*\.png"):
        read_odometry(folder)


def test_unequal_numbers_of_images(tmp_path: Path) -> None:
    folder = odometry(tmp_path)
    (folder / "image_1" / NAMES[1]).unlink()
    with pytest.raises(CommandError, match=r"3 images in .* and 2 in .*000001\.png has no partner"):
        read_odometry(folder)


@pytest.mark.parametrize(
    ("text", "came"),
    [
        ("", "no such line"),
        ("P1: 1 2 3\n", "P1: 1 2 3"),
        (f"P1: {GRAY_RIGHT[:-1]}x\n", "P1: 700"),
        (f"P1: nan{GRAY_RIGHT[3:]}\n", "P1: nan"),
    ],
)
def test_a_calibration_without_the_matrix(tmp_path: Path, text: str, came: str) -> None:
    folder = odometry(tmp_path)
    (folder / "calib.txt").write_text(f"P0: {GRAY_LEFT}\n{text}")
    with pytest.raises(CommandError, match=f"calib.txt: expected a line 'P1: ' with 12 numbers, got {came}"):
        read_odometry(folder)


def test_files_that_are_missing(tmp_path: Path) -> None:
    folder = odometry(tmp_path)
    (folder / "times.txt").unlink()
    with pytest.raises(CommandError, match=r"times\.txt cannot be read"):
        read_odometry(folder)
    (folder / "calib.txt").unlink()
    with pytest.raises(CommandError, match=r"calib\.txt cannot be read"):
        read_odometry(folder)
    drive = raw(tmp_path)
    (drive.parent / "calib_cam_to_cam.txt").unlink()
    with pytest.raises(CommandError, match=r"no calibration: looked for .*calib_cam_to_cam\.txt"):
        read_raw(drive)


@pytest.mark.parametrize(
    ("text", "message"),
    [("0\n1\n", "2 lines, expected 3: none for 000002.png"), ("0\nx\n2\n", "'x'"), ("0\n-1\n2\n", "'-1'")],
)
def test_times_that_do_not_fit(tmp_path: Path, text: str, message: str) -> None:
    folder = odometry(tmp_path)
    (folder / "times.txt").write_text(text)
    with pytest.raises(CommandError, match=f"times.txt.*{message}"):
        read_odometry(folder)


@pytest.mark.parametrize("date", ["yesterday", "2011-09-26 13:02:25.9643894x", "2011-09-31 13:02:25"])
def test_dates_that_are_none(tmp_path: Path, date: str) -> None:
    folder = raw(tmp_path)
    (folder / "image_02/timestamps.txt").write_text(f"{date}\n" * 3)
    with pytest.raises(CommandError, match=rf"timestamps\.txt: expected a date such as .*, got '{date}'"):
        read_raw(folder)


def test_pictures_that_are_none_or_of_unequal_size(tmp_path: Path) -> None:
    folder = odometry(tmp_path)
    cv2.imwrite(str(folder / "image_1" / NAMES[0]), np.zeros((5, 6), np.uint8))
    with pytest.raises(CommandError, match=r"is 40x20 gray and .* 6x5 gray, expected equal"):
        list(load_pairs(read_odometry(folder)))
    (folder / "image_1" / NAMES[0]).write_text("no picture")
    with pytest.raises(CommandError, match=r"000000\.png cannot be read as a picture"):
        list(load_pairs(read_odometry(folder)))


@pytest.mark.parametrize(("number", "count", "offset"), [("01", 51, 0.0), ("02", 20, 45.38225)])
def test_real_sequences(tmp_path: Path, kitti_data: Path, number: str, count: int, offset: float) -> None:
    sequence = read_odometry(kitti_data / "kitti_odometry/sequences" / number)
    assert len(sequence) == count
    assert sequence.P_left[0, 3] == offset
    messages = converted(sequence, tmp_path / "bag")
    assert len(messages.pop("/tf_static")) == 1
    assert [len(of_topic) for of_topic in messages.values()] == [count] * 4
    infos = (messages[f"/{side}/camera_info"][0] for side in ("left", "right"))
    assert 0.5 < camera_from_ros(*infos).baseline < 0.6


def test_real_single_pairs(kitti_data: Path) -> None:
    sequence = read_stereo(kitti_data / "kitti_stereo_2015")
    assert len(sequence) == 52
    assert sequence.P_left[0, 3] == pytest.approx(44.857, abs=1e-3)


@pytest.mark.parametrize("ending", [".jpg", ".jpeg", ".JPG"])
def test_pictures_as_jpeg(tmp_path: Path, ending: str) -> None:
    folder = odometry(tmp_path)
    for image in sorted(folder.glob("image_*/*.png")):
        cv2.imwrite(str(image.with_suffix(".jpg")), cv2.imread(str(image), cv2.IMREAD_UNCHANGED))
        image.with_suffix(".jpg").rename(image.with_suffix(ending))
        image.unlink()
    assert len(converted(read_odometry(folder), tmp_path / "bag")["/left/image_rect"]) == 3


def test_pictures_of_several_kinds_in_one_folder(tmp_path: Path) -> None:
    folder = odometry(tmp_path)
    last = max((folder / "image_1").glob("*.png"))
    cv2.imwrite(str(last.with_suffix(".jpg")), cv2.imread(str(last), cv2.IMREAD_UNCHANGED))
    left, right = read_odometry(folder).left, read_odometry(folder).right
    assert [path.suffix for path in (*left, *right)] == [".png"] * 6  # of one in two forms the .png
    last.unlink()
    right = read_odometry(folder).right
    assert [path.suffix for path in right] == [".png", ".png", ".jpg"]
    assert [path.stem for path in right] == [path.stem for path in left]


def test_text_files_that_windows_wrote(tmp_path: Path) -> None:
    folder, drive = odometry(tmp_path), raw(tmp_path)
    texts = [folder / "calib.txt", folder / "times.txt", drive.parent / "calib_cam_to_cam.txt"]
    texts += [drive / "image_02/timestamps.txt"]
    before = read_odometry(folder), read_raw(drive)
    for path in texts:
        path.write_bytes(b"\xef\xbb\xbf" + path.read_text().replace("\n", "\r\n").encode())
    for old, new in zip(before, (read_odometry(folder), read_raw(drive)), strict=True):
        assert new.stamps_ns == old.stamps_ns
        np.testing.assert_array_equal(new.P_right, old.P_right)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("0\n0\n1\n", "line 2 is '0', expected later"),
        ("0\n2\n1\n", "line 3 is '1', expected later"),
        ("0\n1e-10\n1\n", "line 2 is '1e-10'"),
        ("1" * 5000 + "\n1\n2\n", r"got '1{39}\.\.\."),
    ],
)
def test_times_that_do_not_advance(tmp_path: Path, text: str, message: str) -> None:
    folder = odometry(tmp_path)
    (folder / "times.txt").write_text(text)
    with pytest.raises(CommandError, match=f"times.txt: .*{message}") as caught:
        read_odometry(folder)
    assert len(str(caught.value)) < 200 + len(str(folder))


def single_pairs_of(root: Path, cameras: tuple[str, str], calibration: str, names: tuple[str, str]) -> Path:
    """Write pairs as the official archives unpack: each picture has a calibration of its own."""
    for camera in cameras:
        write_images(
            root / "training" / camera, ("000000_10.png", "000000_11.png", "000007_10.png"), colour=True
        )
    (root / "training" / calibration).mkdir(exist_ok=True)
    for number, focal_length in (("000000", 700), ("000007", 800)):
        left, right = (P.replace("700 0 20", f"{focal_length} 0 20") for P in (COLOUR_LEFT, COLOUR_RIGHT))
        text = f"{names[0]}: {left}\n{names[1]}: {right}\n"
        (root / "training" / calibration / f"{number}.txt").write_text(text)
    return root


@pytest.mark.parametrize(
    ("cameras", "calibration", "names"),
    [
        (("image_2", "image_3"), "calib_cam_to_cam", ("P_rect_02", "P_rect_03")),
        (("image_0", "image_1"), "calib", ("P0", "P1")),
        (("colored_0", "colored_1"), "calib", ("P2", "P3")),
    ],
    ids=["2015", "2012 gray", "2012 colour"],
)
@pytest.mark.parametrize("given", [".", "training"])
def test_single_pairs_with_a_calibration_each(tmp_path, cameras, calibration, names, given) -> None:
    folder = single_pairs_of(tmp_path / "kitti", cameras, calibration, names) / given
    messages = converted(read_stereo(folder), tmp_path / "bag")
    for side, x in (("left", 42), ("right", -336)):
        infos = messages[f"/{side}/camera_info"]
        assert [(info.p[0], info.p[3]) for info in infos] == [(700, x), (800, x)]
        assert len(messages[f"/{side}/image_rect"]) == 2


def test_a_single_pair_without_its_calibration(tmp_path: Path) -> None:
    cameras = ("image_0", "image_1")
    folder = single_pairs_of(tmp_path, cameras, "calib", ("P0", "P1"))
    (folder / "training/calib/000007.txt").unlink()
    with pytest.raises(CommandError, match=r"calib/000007\.txt cannot be read: .*No such file"):
        read_stereo(folder)


# Of a camera that is turned by 0.05 rad and whose lens distorts; its images are larger than rectified ones.
RAW_SIZE, SIZE = (80, 60), (40, 20)
K, D = np.array([[30.0, 0, 40], [0, 30, 30], [0, 0, 1]]), np.array([-0.3, 0.1, 0.001, -0.001, 0.0])
R = cv2.Rodrigues(np.array([0.0, 0.05, 0.0]))[0]


def extract(root: Path) -> Path:
    """Write a drive of the archive `_extract`: pictures (80x60) of two points on a dark ground."""
    folder = raw(root)
    numbers = {
        **{f"S_{camera}": RAW_SIZE for camera in ("02", "03")},
        **{f"S_rect_{camera}": SIZE for camera in ("02", "03")},
        **{f"K_{camera}": K.ravel() for camera in ("02", "03")},
        **{f"D_{camera}": D for camera in ("02", "03")},
        **{f"R_rect_{camera}": R.ravel() for camera in ("02", "03")},
        "P_rect_02": [25, 0, 20, 0, 0, 25, 10, 0, 0, 0, 1, 0],
        "P_rect_03": [25, 0, 20, -13.5, 0, 25, 10, 0, 0, 0, 1, 0],
    }
    lines = [f"{name}: {' '.join(map(str, values))}\n" for name, values in numbers.items()]
    (folder.parent / "calib_cam_to_cam.txt").write_text("".join(lines))
    for camera in ("image_02", "image_03"):
        for name in NAMES:
            cv2.imwrite(str(folder / camera / "data" / name), picture_of_points())
    return folder


POINTS = np.array([[0.2, 0.1, 1.0], [-0.3, -0.1, 1.0]])  # in the rectified camera


def picture_of_points() -> np.ndarray:
    """Return what the camera sees of them: blurred dots where its K, D and R say."""
    image = np.zeros(RAW_SIZE[::-1], np.float32)
    pixels = cv2.projectPoints(POINTS @ R, np.zeros(3), np.zeros(3), K, D)[0].reshape(-1, 2)
    v, u = np.mgrid[: RAW_SIZE[1], : RAW_SIZE[0]]
    for x, y in pixels:
        image += 250 * np.exp(-((u - x) ** 2 + (v - y) ** 2) / 2)
    return np.dstack([np.rint(image).astype(np.uint8)] * 3)


def test_pictures_that_are_not_rectified_are_rectified(tmp_path: Path) -> None:
    messages = converted(read_raw(extract(tmp_path)), tmp_path / "bag")
    image = image_from_ros(messages["/left/image_rect"][0])[:, :, 0].astype(float)
    assert image.shape == SIZE[::-1]
    assert messages["/left/camera_info"][0].width == SIZE[0]
    for x, y, _ in POINTS:
        u, v = 25 * x + 20, 25 * y + 10
        around = image[round(v) - 3 : round(v) + 4, round(u) - 3 : round(u) + 4]
        rows, columns = np.mgrid[round(v) - 3 : round(v) + 4, round(u) - 3 : round(u) + 4]
        centre = (columns * around).sum() / around.sum(), (rows * around).sum() / around.sum()
        assert centre == pytest.approx((u, v), abs=0.2)


def test_pictures_of_another_size_than_their_calibration(tmp_path: Path) -> None:
    folder = extract(tmp_path)
    cv2.imwrite(str(folder / "image_02/data" / NAMES[1]), np.zeros((30, 50, 3), np.uint8))
    message = r"image_02/data/000001\.png is 50x30, its calibration is of 40x20 or 80x60"
    with pytest.raises(CommandError, match=message):
        converted(read_raw(folder), tmp_path / "bag")
