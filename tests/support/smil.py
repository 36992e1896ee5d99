"""Evaluate an animated SVG at a time, as a browser does: the poses and attributes that it shows."""

from __future__ import annotations

import math
import re
from bisect import bisect_right
from xml.etree import ElementTree

SVG = "{http://www.w3.org/2000/svg}"


def evaluate(picture: str, seconds: float) -> ElementTree.Element:
    """Return the tree of a picture with every animated attribute as it is after so many seconds."""
    root = ElementTree.fromstring(picture)
    for element in root.iter():
        for child in list(element):
            if child.tag in (f"{SVG}animate", f"{SVG}animateTransform"):
                value = _value(child, seconds)
                kind = child.get("type")
                element.set(child.get("attributeName"), f"{kind}({value})" if kind else value)
                element.remove(child)
    return root


def _value(animation: ElementTree.Element, seconds: float) -> str:
    duration = float(animation.get("dur").removesuffix("s"))
    assert animation.get("repeatCount") == "indefinite"
    times = [float(time) for time in animation.get("keyTimes").split(";")]
    values = animation.get("values").split(";")
    assert len(times) == len(values)
    assert times == sorted(times)
    assert times[0] == 0
    share = seconds % duration / duration
    index = bisect_right(times, share) - 1
    if animation.get("calcMode") == "discrete":
        return values[index]
    assert times[-1] == 1, "a browser ignores an animation that does not end"
    one, other = ([*map(float, values[i].split())] for i in (index, index + 1))
    along = (share - times[index]) / (times[index + 1] - times[index])
    return " ".join(str(a + (b - a) * along) for a, b in zip(one, other, strict=True))


def placed(root: ElementTree.Element, fill: str) -> list[tuple[float, float, float, ElementTree.Element]]:
    """Return x, y, angle (radians) and the element of all visible shapes with a colour."""
    found = []

    def walk(element, x, y, angle, is_visible):
        is_visible = element.get("visibility", "visible" if is_visible else "hidden") == "visible"
        for kind, numbers in re.findall(r"(translate|rotate)\(([^)]*)\)", element.get("transform", "")):
            if kind == "rotate":
                angle += math.radians(float(numbers))
            elif "scale" not in element.get("transform"):
                dx, dy = map(float, numbers.split())
                x, y = x + dx, y + dy
        if element.get("fill") == fill and is_visible:
            found.append((x, y, angle, element))
        for child in element:
            walk(child, x, y, angle, is_visible)

    walk(root, 0.0, 0.0, 0.0, True)
    return found
