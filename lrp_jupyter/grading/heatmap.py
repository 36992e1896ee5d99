"""Heat maps of sweeps as SVG: self-contained, legible on light and dark pages.

Colours are those of *cividis*: evenly spaced in brightness, and the same order to people who see fewer
colours. What matters is never told by a colour alone: failed runs are crossed, shares are written down.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from html import escape

from lrp_jupyter.grading.grade import Grade
from lrp_jupyter.graph.labels import text_width

_SCALE = ((0, 34, 78), (53, 69, 108), (102, 105, 112), (148, 142, 119), (200, 184, 102), (254, 232, 56))
_FONT = 12
_STYLE = f"""
.lrp-map text{{font:{_FONT}px system-ui,'Segoe UI',Roboto,'DejaVu Sans',sans-serif;fill:#1f2328}}
.lrp-map .title{{font-weight:600}}.lrp-map .paper{{fill:#fff}}.lrp-map .failed{{fill:#fff;stroke:#d4d8de}}
.lrp-map .cross,.lrp-map .mark{{stroke:#1f2328;fill:none}}.lrp-map .cross{{stroke-width:1.2}}
.lrp-map .mark{{stroke-width:2.5}}.lrp-map .halo{{stroke-width:6;stroke:#fff;fill:none}}
.lrp-map .robust{{stroke-dasharray:5 3}}
.lrp-map .on-dark{{fill:#fff}}.lrp-map .on-light{{fill:#000}}
@media (prefers-color-scheme:dark){{.lrp-map text{{fill:#e6e8eb}}.lrp-map .paper{{fill:#1b1e23}}
.lrp-map .failed{{fill:#1b1e23;stroke:#3d444d}}.lrp-map .cross,.lrp-map .mark{{stroke:#e6e8eb}}
.lrp-map .halo{{stroke:#1b1e23}}.lrp-map .on-dark{{fill:#fff}}.lrp-map .on-light{{fill:#000}}}}
"""
_EDGE = 16.0  # px around everything


def _colour(share: float) -> tuple[str, bool]:
    """Return the colour of 0 … 1, dark to light, and whether dark text is legible on it."""
    place = min(max(share, 0.0), 1.0) * (len(_SCALE) - 1)
    index = min(int(place), len(_SCALE) - 2)
    mixed = [
        low + (high - low) * (place - index)
        for low, high in zip(_SCALE[index], _SCALE[index + 1], strict=True)
    ]
    red, green, blue = mixed
    return "#" + "".join(f"{round(each):02x}" for each in mixed), 0.3 * red + 0.59 * green + 0.11 * blue > 120


def by_run(
    title: str, variable: str, values: Sequence[str], grades: Sequence[Grade], remarks: Sequence[str]
) -> str:
    """Return the map of one variable: a column for each value, a row for each run, coloured by its time.

    `grades`: one for each value. A run that was not made counts as failed.
    `remarks`: ``fastest`` or ``most robust`` below a value.
    """
    rows = list(dict.fromkeys((each.world, each.seed) for grade in grades for each in grade.attempts))
    times = [each.seconds for grade in grades for each in grade.attempts if each.passed]
    low, high = min(times, default=0.0), max(times, default=0.0)
    worlds = list(dict.fromkeys(world for world, _ in rows))
    width = _wide([*values, *(word for remark in remarks for word in remark.split(", "))], 44)
    height = 14.0 if len(rows) <= 40 else max(4.0, 560 / len(rows))
    names = [world if len(worlds) > 1 else "" for world in worlds]
    left = _EDGE + max(text_width(name, _FONT) for name in [*names, "seed"]) + 44
    top = _EDGE + 58
    parts = [_text(left - 8, top - 6, "passed", "end")]
    for column, (value, grade, remark) in enumerate(zip(values, grades, remarks, strict=True)):
        x = left + column * width
        done = {(each.world, each.seed): each for each in grade.attempts}
        parts.append(_text(x + width / 2, top - 6, f"{grade.runs_passed}/{grade.runs}", "middle"))
        for row, (world, seed) in enumerate(rows):
            attempt, y = done.get((world, seed)), top + row * height
            about = f"{variable} = {value}, {world}, seed {seed}"
            if attempt is None or not attempt.passed:
                why = (attempt and attempt.reason) or "not made"
                parts.append(_failed(x, y, width, height, f"{about}: {why}"))
                continue
            colour, _ = _colour(1 - (attempt.seconds - low) / (high - low) if high > low else 1)
            parts.append(_cell(x, y, width, height, colour, f"{about}: {attempt.seconds:.1f} s"))
        bottom = top + len(rows) * height
        parts.append(_text(x + width / 2, bottom + 18, value, "middle"))
        for line, word in enumerate(filter(None, remark.split(", "))):
            parts.append(_text(x + width / 2, bottom + 34 + 15 * line, word, "middle"))
            parts.append(_mark(x, top, width, bottom - top, word))
    parts += _rows(rows, names, worlds, left, top, height)
    middle = left + width * len(values) / 2
    parts.append(_text(middle, bottom + 68, variable, "middle"))
    right, legend = _legend(left, bottom + 92, f"{high:.1f} s", f"{low:.1f} s", "done after", bool(times))
    right = max(right, left + width * len(values), _EDGE + text_width(title, _FONT) * 1.1)
    return _page(title, right + _EDGE, bottom + 120, [*parts, *legend])


def _rows(
    rows: Sequence[tuple[str, int]],
    names: Sequence[str],
    worlds: Sequence[str],
    left: float,
    top: float,
    height: float,
) -> Iterator[str]:
    """Yield the labels of the rows: as many seeds as there is room for, and the worlds."""
    every = max(1, -(-_FONT // int(height)))
    for row, (_, seed) in enumerate(rows):
        if seed % every == 0:
            yield _text(left - 8, top + (row + 0.5) * height + 4, str(seed), "end")
    for name, world in zip(names, worlds, strict=True):
        first = next(row for row, (each, _) in enumerate(rows) if each == world)
        yield _text(_EDGE, top + first * height + 11, name, "start")
    yield _text(left - 8, top + len(rows) * height + 18, "seed ↑", "end")


def by_values(
    title: str,
    variables: Sequence[str],
    axes: tuple[Sequence[str], Sequence[str]],
    shares: Sequence[float],
    remarks: Sequence[str],
) -> str:
    """Return the map of two variables: the share of the runs that passed for each pair of values.

    `variables`: the first one is drawn to the right, the second one upwards.
    `axes`: their values.
    `shares`: 0 to 1; those of the second variable change fastest.
    `remarks`: as with :func:`by_run`.
    """
    across, up = axes
    width, height = _wide([*across, "100%"], 52), 34.0
    left = _EDGE + max(text_width(each, _FONT) for each in [*up, variables[1]]) + 14
    top = _EDGE + 52
    bottom = top + height * len(up)
    parts = [_text(left - 8, top - 10, f"{variables[1]} ↓", "end")]
    marks = []
    for index, (share, remark) in enumerate(zip(shares, remarks, strict=True)):
        column, row = divmod(index, len(up))
        x, y = left + column * width, bottom - (row + 1) * height
        colour, is_light = _colour(share)
        about = f"{variables[0]} = {across[column]}, {variables[1]} = {up[row]}: {share:.0%} passed"
        parts.append(_cell(x, y, width, height, colour, about))
        where = "on-light" if is_light else "on-dark"
        parts.append(_text(x + width / 2, y + height / 2 + 4, f"{share:.0%}", "middle", where))
        marks += [_mark(x, y, width, height, word) for word in filter(None, remark.split(", "))]
    for row, value in enumerate(up):
        parts.append(_text(left - 8, bottom - (row + 0.5) * height + 4, value, "end"))
    for column, value in enumerate(across):
        parts.append(_text(left + (column + 0.5) * width, bottom + 18, value, "middle"))
    parts.append(_text(left + width * len(across) / 2, bottom + 38, variables[0], "middle"))
    right, legend = _legend(left, bottom + 62, "0%", "100%", "passed", True, failed=False)
    x = right + 24
    for word in ("fastest", "most robust"):
        legend += [_mark(x, bottom + 62, 20, 14, word), _text(x + 28, bottom + 74, word, "start")]
        x += 28 + text_width(word, _FONT) + 24
    right = max(x, left + width * len(across), _EDGE + text_width(title, _FONT) * 1.1)
    return _page(title, right + _EDGE, bottom + 92, [*parts, *marks, *legend])


def _wide(labels: Sequence[str], least: float) -> float:
    return max(least, *(text_width(label, _FONT) + 12 for label in labels))


def _legend(
    x: float, y: float, low: str, high: str, what: str, is_scaled: bool, failed: bool = True
) -> tuple[float, list[str]]:
    """Return where the legend ends, and its parts: the scale of colours, and the sign of failed runs."""
    parts = [_text(x, y + 12, what, "start")]
    x += text_width(what, _FONT) + 10
    if is_scaled:
        parts.append(_text(x, y + 12, low, "start"))
        x += text_width(low, _FONT) + 8
        for step in range(20):
            parts.append(_cell(x + 6 * step, y, 6.5, 14, _colour(step / 19)[0], ""))
        x += 128
        parts.append(_text(x, y + 12, high, "start"))
        x += text_width(high, _FONT) + 24
    if failed:
        parts += [_failed(x, y, 20, 14, ""), _text(x + 28, y + 12, "did not pass", "start")]
        x += 28 + text_width("did not pass", _FONT)
    return x, parts


def _text(x: float, y: float, text: str, anchor: str, kind: str = "") -> str:
    named = f' class="{kind}"' if kind else ""
    return f'<text{named} x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{escape(text)}</text>'


def _cell(x: float, y: float, width: float, height: float, colour: str, about: str) -> str:
    inside = f"><title>{escape(about)}</title></rect>" if about else "/>"
    return f'<rect {_box(x, y, width, height)} fill="{colour}"{inside}'


def _failed(x: float, y: float, width: float, height: float, about: str) -> str:
    """Return an empty cell with a cross."""
    inside = f"><title>{escape(about)}</title></rect>" if about else "/>"
    middle, half, arm = x + width / 2, y + height / 2, min(height, 14) / 2 - 1.5
    cross = (
        f"M{middle - arm:.1f} {half - arm:.1f}l{2 * arm:.1f} {2 * arm:.1f}"
        f"m0 {-2 * arm:.1f}l{-2 * arm:.1f} {2 * arm:.1f}"
    )
    return f'<rect class="failed" {_box(x, y, width, height)}{inside}<path class="cross" d="{cross}"/>'


def _mark(x: float, y: float, width: float, height: float, word: str) -> str:
    """Return the outline of what is the fastest (a line) or the most robust (dashes, outside of it)."""
    kind, out = ("mark robust", 2.5) if word == "most robust" else ("mark", 0.0)
    box = _box(x - out, y - out, width + 2 * out, height + 2 * out)
    return f'<rect class="halo" {box}/><rect class="{kind}" {box}/>'


def _box(x: float, y: float, width: float, height: float) -> str:
    return f'x="{x:.1f}" y="{y:.1f}" width="{width:.1f}" height="{height:.1f}"'


def _page(title: str, width: float, height: float, parts: Sequence[str]) -> str:
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" class="lrp-map" role="img" width="{width:.0f}" '
        f'height="{height:.0f}" viewBox="0 0 {width:.0f} {height:.0f}"><title>{escape(title)}</title>'
        f'<style>{_STYLE}</style><rect class="paper" width="100%" height="100%" rx="6"/>'
        f"{_text(_EDGE, _EDGE + 14, title, 'start', 'title')}{''.join(parts)}</svg>\n"
    )
