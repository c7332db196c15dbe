# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""sensor_msgs/Image and CompressedImage to arrays, and back."""

from __future__ import annotations

from typing import Any, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.messages.make import Make

Image8 = NDArray[np.uint8]
JPEG_QUALITY = 95


class Encoding(NamedTuple):
    """How the pixels of a sensor_msgs/Image lie in its bytes, and how they become gray or BGR."""

    channels: int
    depth_bytes: int
    to_bgr: int | None  # code for cv2.cvtColor; None: gray or BGR already


# ROS names a Bayer pattern by its first two rows ("rggb"), OpenCV's classic names by the second
# row's second and third pixel (BG); OpenCV's newer names, used here, are those of ROS.
ENCODINGS = {
    "mono8": Encoding(1, 1, None),
    "bgr8": Encoding(3, 1, None),
    "rgb8": Encoding(3, 1, cv2.COLOR_RGB2BGR),
    "bgra8": Encoding(4, 1, cv2.COLOR_BGRA2BGR),
    "rgba8": Encoding(4, 1, cv2.COLOR_RGBA2BGR),
    "mono16": Encoding(1, 2, None),
    "bgr16": Encoding(3, 2, None),
    "rgb16": Encoding(3, 2, cv2.COLOR_RGB2BGR),
    "8UC1": Encoding(1, 1, None),
    "8UC3": Encoding(3, 1, None),
    "16UC1": Encoding(1, 2, None),
    "uyvy": Encoding(2, 1, cv2.COLOR_YUV2BGR_UYVY),
    "yuv422": Encoding(2, 1, cv2.COLOR_YUV2BGR_UYVY),
    "yuyv": Encoding(2, 1, cv2.COLOR_YUV2BGR_YUY2),
    "yuv422_yuy2": Encoding(2, 1, cv2.COLOR_YUV2BGR_YUY2),
    **{
        f"bayer_{pattern}{8 * depth_bytes}": Encoding(1, depth_bytes, code)
        for pattern, code in (
            ("rggb", cv2.COLOR_BayerRGGB2BGR),
            ("bggr", cv2.COLOR_BayerBGGR2BGR),
            ("gbrg", cv2.COLOR_BayerGBRG2BGR),
            ("grbg", cv2.COLOR_BayerGRBG2BGR),
        )
        for depth_bytes in (1, 2)
    },
}
# Bytes without which a compressed image was cut off: decoders fill the missing rows with gray.
ENDS = {"JPEG": (b"\xff\xd8\xff", b"\xff\xd9"), "PNG": (b"\x89PNG", b"IEND")}


def image_from_ros(msg: Any) -> Image8:
    """Return the picture of a sensor_msgs/Image as uint8, (H, W) gray or (H, W, 3) BGR.

    `step` padding and big-endian data are honoured; the result may share the message's memory. 16-bit
    pixels are shifted down so that the brightest one fills the 8 bits, see `stereo_images_from_ros`.
    Raises ValueError for an unsupported encoding, an empty image, or bytes too few for its size.
    """
    image = _pixels(msg)
    return _to_uint8(image, _significant_bits(image))


def compressed_image_from_ros(msg: Any) -> Image8:
    """Return the picture of a sensor_msgs/CompressedImage (JPEG, PNG) as `image_from_ros` does.

    Raises ValueError for data that is not a whole JPEG or PNG image.
    """
    image = _decoded(msg)
    return _to_uint8(image, _significant_bits(image))


def stereo_images_from_ros(left: Any, right: Any) -> tuple[Image8, Image8]:
    """Return the pictures of two messages, both sensor_msgs/Image or both CompressedImage.

    16-bit pixels keep 8 bits below the highest bit in use of 10, 12, 14 or 16, judged by the brightest
    pixel of *both* images: a 12-bit camera does not come out black, and left and right keep the same scale.
    Raises ValueError as `image_from_ros` does, naming the side.
    """
    images = [_side(side, msg) for side, msg in (("left", left), ("right", right))]
    bits = max(_significant_bits(image) for image in images)
    return _to_uint8(images[0], bits), _to_uint8(images[1], bits)


def left_image_from_ros(left: Any) -> Image8:
    """Return the picture of a left image that came alone. Raises ValueError as `stereo_images_from_ros`."""
    image = _side("left", left)
    return _to_uint8(image, _significant_bits(image))


def _side(side: str, msg: Any) -> NDArray[Any]:
    try:
        return _decoded(msg) if hasattr(msg, "format") else _pixels(msg)
    except ValueError as error:
        raise ValueError(f"{side} image: {error}") from error


def _pixels(msg: Any) -> NDArray[Any]:
    """Return the pixels, uint8 or uint16, (H, W) or (H, W, 3) BGR, of a sensor_msgs/Image."""
    encoding = ENCODINGS.get(msg.encoding)
    if encoding is None:
        raise ValueError(f"encoding is {msg.encoding!r}, expected one of {', '.join(ENCODINGS)}")
    height, width, step = int(msg.height), int(msg.width), int(msg.step)
    if height < 1 or width < 1:
        raise ValueError(f"size is {width}x{height}, expected at least 1x1")
    if encoding.channels == 2 and width % 2:
        raise ValueError(f"{width} columns of {msg.encoding}, expected an even number: two share a colour")
    row_bytes = width * encoding.channels * encoding.depth_bytes
    if step < row_bytes:
        raise ValueError(f"step is {step} bytes, expected >= {row_bytes} ({width} px of {msg.encoding})")
    data = np.frombuffer(msg.data, np.uint8)
    if data.size < step * height:
        expected = f"{step * height} (step {step} x height {height})"
        raise ValueError(f"data has {data.size} bytes, expected {expected}")
    rows = np.ascontiguousarray(data[: step * height].reshape(height, step)[:, :row_bytes])
    if encoding.depth_bytes == 2:
        rows = rows.view(">u2" if msg.is_bigendian else "<u2").astype(np.uint16, copy=False)
    pixels = rows if encoding.channels == 1 else rows.reshape(height, width, encoding.channels)
    return pixels if encoding.to_bgr is None else cv2.cvtColor(pixels, encoding.to_bgr)


def _decoded(msg: Any) -> NDArray[Any]:
    """Return the pixels, uint8 or uint16, (H, W) or (H, W, 3) BGR, of a sensor_msgs/CompressedImage."""
    data = bytes(msg.data)
    kind = next((kind for kind, (start, _) in ENDS.items() if data.startswith(start)), None)
    if kind is None or "compressedDepth" in msg.format:
        raise ValueError(f"format is {msg.format!r}, {len(data)} bytes, expected a JPEG or PNG image")
    if ENDS[kind][1] not in data:
        raise ValueError(f"{kind} data ends early after {len(data)} bytes, expected a whole image")
    flags = (
        cv2.IMREAD_ANYCOLOR | cv2.IMREAD_ANYDEPTH | cv2.IMREAD_IGNORE_ORIENTATION
    )  # as the CameraInfo has it
    image = cv2.imdecode(np.frombuffer(data, np.uint8), flags)
    if image is None:
        raise ValueError(f"{kind} data of {len(data)} bytes cannot be decoded, expected a whole image")
    return _without_mosaic(image, msg.format)


def _without_mosaic(image: NDArray[Any], form: str) -> NDArray[Any]:
    """Return a picture, a mosaic in colour: "bayer_rggb8; jpeg compressed mono8" holds none any more."""
    camera, _, packing = form.partition(";")
    packed = packing.partition("compressed")[2].strip()
    mosaic = ENCODINGS.get(packed or camera.strip())
    if image.ndim == 2 and mosaic is not None and mosaic.channels == 1 and mosaic.to_bgr is not None:
        return cv2.cvtColor(image, mosaic.to_bgr)
    return image


def _significant_bits(image: NDArray[Any]) -> int:
    """Return 8, 10, 12, 14 or 16: how many bits per pixel the camera that took this picture uses."""
    if image.dtype == np.uint8:
        return 8
    used = int(image.max()).bit_length()
    return max(8, used + used % 2)


def _to_uint8(image: NDArray[Any], bits: int) -> Image8:
    return image if image.dtype == np.uint8 else (image >> (bits - 8)).astype(np.uint8)


def image_to_ros(image: Image8, header: Any, make: Make) -> Any:
    """Return a uint8 picture, (H, W) gray or (H, W, 3) BGR, as sensor_msgs/Image mono8 or bgr8.

    Raises ValueError for an array of another type or shape.
    """
    if image.dtype != np.uint8 or not (image.ndim == 2 or (image.ndim == 3 and image.shape[2] == 3)):
        raise ValueError(f"image is {image.dtype} {image.shape}, expected uint8 (H, W) or (H, W, 3)")
    height, width = image.shape[:2]
    return make(
        "sensor_msgs/msg/Image",
        header=header,
        height=height,
        width=width,
        encoding="mono8" if image.ndim == 2 else "bgr8",
        is_bigendian=0,
        step=image.size // height,
        data=np.ascontiguousarray(image).reshape(-1),
    )


def compressed_image_to_ros(image: Image8, header: Any, make: Make) -> Any:
    """Return a uint8 picture as a JPEG in sensor_msgs/CompressedImage.

    Its format is written as compressed_image_transport does.
    """
    encoding = "mono8" if image.ndim == 2 else "bgr8"
    _, data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
    form = f"{encoding}; jpeg compressed {encoding}"
    return make("sensor_msgs/msg/CompressedImage", header=header, format=form, data=data)
