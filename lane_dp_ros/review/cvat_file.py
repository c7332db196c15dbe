# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The XML format "CVAT for images 1.1": https://docs.cvat.ai/docs/other/xml_format."""

from __future__ import annotations

import re
from collections.abc import Sequence
from xml.etree import ElementTree

from lane_dp_ros.review.polylines import AnnotatedImage, Polyline, checked_points, checked_size, short

VERSION = "1.1"
Choices = dict[str, tuple[str, ...]]  # of an attribute; none: free text


def to_cvat(images: Sequence[AnnotatedImage], labels: Sequence[str], attributes: Choices) -> str:
    """Return images as the text of a file; `labels` and their `attributes` are declared in its head."""
    root = ElementTree.Element("annotations")
    _add_text(root, "version", VERSION)
    task = ElementTree.SubElement(ElementTree.SubElement(root, "meta"), "task")
    for name, text in (("size", str(len(images))), ("mode", "annotation")):
        _add_text(task, name, text)
    declared = ElementTree.SubElement(task, "labels")
    for label in labels:
        _declare(declared, label, attributes)
    for number, image in enumerate(images):
        _add_image(root, number, image)
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + ElementTree.tostring(root, "unicode") + "\n"


def from_cvat(text: str) -> tuple[AnnotatedImage, ...]:
    """Return the images of a file. Raises ValueError naming image and field."""
    if re.search("<!(DOCTYPE|ENTITY)", text):  # entities could unpack to anything
        raise ValueError("the XML declares a document type, CVAT's files have none")
    try:
        root = ElementTree.fromstring(text.lstrip("\ufeff"))
    except ElementTree.ParseError as error:
        raise ValueError(f"no whole XML: {error}") from None
    if root.tag != "annotations":
        raise ValueError(f"the XML is <{root.tag}>, expected <annotations> of CVAT for images")
    if root.find("track") is not None:
        raise ValueError("the XML is CVAT for video (<track>), expected an export as CVAT for images 1.1")
    return tuple(_image(element, number) for number, element in enumerate(root.findall("image")))


def _add_text(parent: ElementTree.Element, name: str, text: str) -> None:
    ElementTree.SubElement(parent, name).text = text


def _declare(labels: ElementTree.Element, name: str, attributes: Choices) -> None:
    label = ElementTree.SubElement(labels, "label")
    _add_text(label, "name", name)
    _add_text(label, "type", "polyline")
    declared = ElementTree.SubElement(label, "attributes")
    for attribute, choices in attributes.items():
        entry = ElementTree.SubElement(declared, "attribute")
        fields = {
            "name": attribute,
            "mutable": "False",
            "input_type": "select" if choices else "text",
            "default_value": choices[0] if choices else "",
            "values": "\n".join(choices),
        }
        for field, text in fields.items():
            _add_text(entry, field, text)


def _add_image(root: ElementTree.Element, number: int, image: AnnotatedImage) -> None:
    width, height = map(str, image.size)
    element = ElementTree.SubElement(
        root, "image", id=str(number), name=image.name, width=width, height=height
    )
    for line in image.polylines:
        points = ";".join(f"{x:.2f},{y:.2f}" for x, y in line.points)
        shape = ElementTree.SubElement(
            element, "polyline", label=line.label, source="manual", occluded="0", points=points, z_order="0"
        )
        for name, value in line.attributes.items():
            ElementTree.SubElement(shape, "attribute", name=name).text = value


def _image(element: ElementTree.Element, number: int) -> AnnotatedImage:
    name = element.get("name")
    if not name:
        raise ValueError(f"<image> {number + 1} has no name")
    where = f"image {short(name)}"
    size = checked_size(element.get("width"), element.get("height"), where)
    shapes = [shape for shape in element if shape.tag != "tag"]
    found = [shape for shape in shapes if shape.tag == "polyline"]
    lines = (_polyline(shape, size, f"{where}, polyline {i + 1}") for i, shape in enumerate(found))
    return AnnotatedImage(name, size, tuple(lines), len(shapes) - len(found))


def _polyline(shape: ElementTree.Element, size: tuple[int, int], where: str) -> Polyline:
    pairs = [pair.split(",") for pair in shape.get("points", "").split(";")]
    if any(len(pair) != 2 for pair in pairs):
        raise ValueError(f"{where}: points is {short(shape.get('points'))}, expected x,y;x,y;...")
    points = checked_points([value for pair in pairs for value in pair], size, f"{where}: points")
    attributes = {a.get("name", ""): (a.text or "").strip() for a in shape.findall("attribute")}
    return Polyline(shape.get("label", ""), attributes, points)
