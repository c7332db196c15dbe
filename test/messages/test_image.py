# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Images to arrays and back, on rclpy's own messages."""

import cv2
import numpy as np
import pytest
from builtin_interfaces.msg import Time
from rclpy.serialization import deserialize_message, serialize_message
from rosbags.image import message_to_cvimage
from sensor_msgs.msg import CompressedImage
from std_msgs.msg import Header

from lane_dp_ros.messages.image import (
    ENCODINGS,
    compressed_image_from_ros,
    image_from_ros,
    image_to_ros,
    stereo_images_from_ros,
)
from lane_dp_ros.ros.rclpy_message import rclpy_message

HEADER = Header(stamp=Time(sec=12, nanosec=345), frame_id="left_optical")
RNG = np.random.default_rng(1)


def image_message(pixels, encoding, padding=0, big_endian=False):
    """A sensor_msgs/Image of (H, W) or (H, W, C) pixels with `padding` bytes of 0xAB after each row."""
    height, width = pixels.shape[:2]
    stored = pixels.astype(pixels.dtype.newbyteorder(">" if big_endian else "<"))
    rows = np.frombuffer(stored.tobytes(), np.uint8).reshape(height, -1)
    rows = np.pad(rows, ((0, 0), (0, padding)), constant_values=0xAB)
    return rclpy_message(
        "sensor_msgs/msg/Image",
        header=HEADER,
        height=height,
        width=width,
        encoding=encoding,
        is_bigendian=int(big_endian),
        step=rows.shape[1],
        data=rows,
    )


def random_pixels(encoding, height=12, width=17):
    channels, depth_bytes, _ = ENCODINGS[encoding]
    dtype = np.uint8 if depth_bytes == 1 else np.uint16
    width -= channels == 2  # two columns share a colour
    shape = (height, width) if channels == 1 else (height, width, channels)
    return RNG.integers(0, np.iinfo(dtype).max, shape, dtype, endpoint=True)


@pytest.mark.parametrize("encoding", sorted(ENCODINGS))
@pytest.mark.parametrize("padding", [0, 5])
def test_every_encoding_reads_as_the_rosbags_library_reads_it(encoding, padding):
    pixels = random_pixels(encoding)
    pixels.flat[0] = np.iinfo(pixels.dtype).max  # all bits of 16 are in use
    as_it_is = encoding in ("mono8", "mono16", "8UC1", "8UC3", "16UC1")
    wanted = None if as_it_is else f"bgr{8 * pixels.itemsize}"
    expected = message_to_cvimage(image_message(pixels, encoding), wanted)
    expected = expected >> 8 if expected.dtype == np.uint16 else expected
    np.testing.assert_array_equal(image_from_ros(image_message(pixels, encoding, padding)), expected)


def test_half_a_pixel_of_uyvy_is_refused():
    with pytest.raises(ValueError, match="17 columns of uyvy, expected an even number"):
        image_from_ros(image_message(np.zeros((4, 17, 2), np.uint8), "uyvy"))


@pytest.mark.parametrize(
    ("encoding", "mosaic"),
    [
        ("bayer_rggb8", [[200, 0], [0, 0]]),
        ("bayer_bggr8", [[0, 0], [0, 200]]),
        ("bayer_grbg8", [[0, 200], [0, 0]]),
        ("bayer_gbrg8", [[0, 0], [200, 0]]),
    ],
)
def test_a_red_scene_stays_red_through_each_bayer_pattern(encoding, mosaic):
    scene = np.tile(np.array(mosaic, np.uint8), (5, 5))
    assert image_from_ros(image_message(scene, encoding))[5, 5].tolist() == [0, 0, 200]


@pytest.mark.parametrize("big_endian", [False, True])
@pytest.mark.parametrize("padding", [0, 3])
def test_mono16_keeps_its_high_byte_in_either_byte_order(big_endian, padding):
    pixels = random_pixels("mono16")
    pixels[0, 0] = 0xFFFF
    got = image_from_ros(image_message(pixels, "mono16", padding, big_endian))
    np.testing.assert_array_equal(got, pixels >> 8)


def test_a_12_bit_camera_in_16_bits_does_not_come_out_black():
    pixels = np.array([[0, 2048, 4095]], np.uint16)
    assert image_from_ros(image_message(pixels, "mono16")).tolist() == [[0, 128, 255]]


def test_left_and_right_of_mono16_keep_one_scale():
    dark, bright = (np.array([[100, peak]], np.uint16) for peak in (1000, 4000))
    left, right = stereo_images_from_ros(image_message(dark, "mono16"), image_message(bright, "mono16"))
    assert left.tolist() == [[6, 62]] and right.tolist() == [[6, 250]]


def changed(**fields):
    msg = image_message(random_pixels("bgr8"), "bgr8")
    for name, value in fields.items():
        setattr(msg, name, value)
    return msg


@pytest.mark.parametrize(
    ("fields", "match"),
    [
        ({"encoding": "32FC1"}, r"encoding is '32FC1', expected one of mono8, bgr8"),
        ({"encoding": ""}, r"encoding is '', expected one of"),
        ({"height": 0}, r"size is 17x0, expected at least 1x1"),
        ({"width": 0}, r"size is 0x12, expected at least 1x1"),
        ({"step": 50}, r"step is 50 bytes, expected >= 51 \(17 px of bgr8\)"),
        ({"height": 13}, r"data has 612 bytes, expected 663 \(step 51 x height 13\)"),
    ],
)
def test_a_broken_image_is_answered_in_one_line(fields, match):
    with pytest.raises(ValueError, match=match) as caught:
        image_from_ros(changed(**fields))
    assert "\n" not in str(caught.value)
    with pytest.raises(ValueError, match="^right image: " + match):
        stereo_images_from_ros(changed(), changed(**fields))


@pytest.mark.parametrize("shape", [(7, 9), (7, 9, 3), (1, 1), (1, 1, 3)])
def test_image_round_trip_over_the_wire(shape):
    image = RNG.integers(0, 255, shape, np.uint8)
    sent = image_to_ros(image, HEADER, rclpy_message)
    received = deserialize_message(serialize_message(sent), type(sent))
    np.testing.assert_array_equal(image_from_ros(received), image)
    assert received.header == HEADER


def test_image_to_ros_takes_views_and_refuses_other_arrays():
    image = RNG.integers(0, 255, (8, 8, 3), np.uint8)
    view = image[::2, 1:5]
    np.testing.assert_array_equal(image_from_ros(image_to_ros(view, HEADER, rclpy_message)), view)
    with pytest.raises(ValueError, match=r"image is float64 \(2, 2\), expected uint8"):
        image_to_ros(np.zeros((2, 2)), HEADER, rclpy_message)


def compressed(image, extension, format_):
    data = cv2.imencode(extension, image)[1].tobytes()
    return CompressedImage(header=HEADER, format=format_, data=data)


def test_png_is_exact_and_jpeg_close_in_gray_and_colour():
    smooth = cv2.GaussianBlur(RNG.integers(0, 255, (40, 60, 3), np.uint8), (0, 0), 4)
    for image in (smooth, smooth[:, :, 0]):
        np.testing.assert_array_equal(compressed_image_from_ros(compressed(image, ".png", "png")), image)
        jpeg = compressed_image_from_ros(compressed(image, ".jpg", "bgr8; jpeg compressed bgr8"))
        assert jpeg.shape == image.shape
        assert np.abs(jpeg.astype(int) - image).mean() < 3


def test_a_16_bit_png_is_scaled_like_mono16():
    pixels = np.array([[0, 2048, 4095]], np.uint16)
    msg = compressed(pixels, ".png", "mono16; png compressed")
    assert compressed_image_from_ros(msg).tolist() == [[0, 128, 255]]


def test_a_gray_jpeg_of_a_bayer_camera_is_no_mosaic():
    scene = np.tile(np.uint8([[200, 0], [0, 0]]), (5, 5))
    msg = compressed(scene, ".png", "bayer_rggb8; png compressed mono8")
    np.testing.assert_array_equal(compressed_image_from_ros(msg), scene)


def test_the_orientation_in_a_jpeg_is_ignored():
    whole = bytes(compressed(np.zeros((40, 60), np.uint8), ".jpg", "jpeg").data)
    turned = b"\xff\xe1\x00\x22Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0"
    msg = CompressedImage(format="jpeg", data=whole[:2] + turned + whole[2:])
    assert cv2.imdecode(np.frombuffer(msg.data, np.uint8), cv2.IMREAD_GRAYSCALE).shape == (60, 40)
    assert compressed_image_from_ros(msg).shape == (40, 60)


def test_a_bayer_png_is_demosaiced():
    scene = np.tile(np.array([[200, 0], [0, 0]], np.uint8), (5, 5))
    msg = compressed(scene, ".png", "bayer_rggb8; png compressed ")
    assert compressed_image_from_ros(msg)[5, 5].tolist() == [0, 0, 200]


@pytest.mark.parametrize("extension", [".jpg", ".png"])
def test_a_truncated_compressed_image_is_refused(extension):
    whole = compressed(RNG.integers(0, 255, (40, 60), np.uint8), extension, "x")
    for size in (4, 100, len(whole.data) - 8):
        cut = CompressedImage(format="x", data=bytes(whole.data)[:size])
        with pytest.raises(ValueError, match=rf"data ends early after {size} bytes, expected a whole image"):
            compressed_image_from_ros(cut)


@pytest.mark.parametrize("data", [b"", b"GIF89a"])
def test_what_is_neither_jpeg_nor_png_is_refused(data):
    with pytest.raises(ValueError, match=rf"'h264', {len(data)} bytes, expected a JPEG or PNG image"):
        compressed_image_from_ros(CompressedImage(format="h264", data=data))
    with pytest.raises(ValueError, match="cannot be decoded"):
        compressed_image_from_ros(CompressedImage(format="jpeg", data=b"\xff\xd8\xff\xe0 nonsense \xff\xd9"))
