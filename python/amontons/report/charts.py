"""Charts as SVG text: lines, stacked columns, coloured patches. Nothing is loaded, nothing moves.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

#: Colours that a colour-blind reader can distinguish.
COLOURS = ["#2166ac", "#d95f02", "#1b9e77", "#7b3294", "#a6761d", "#666666"]
VIRIDIS = ["#440154", "#482878", "#3e4989", "#31688e", "#26828e", "#1f9e89", "#35b779", "#6ece58", "#b5de2b", "#fde725"]
STATUS = ["#dfe4e8", "#2f6db3", "#f28e2b"]
WIDTH, HEIGHT = 720, 260
LEFT, RIGHT, TOP, BOTTOM = 64, 12, 12, 40


def number(value: float) -> str:
    """A number for people."""
    if value == 0 or not math.isfinite(value):
        return "0" if value == 0 else "-"
    text = f"{value:.4g}"
    if abs(value) < 1e-3 and "e" not in text:
        power = math.floor(math.log10(abs(value)) + 1e-12)
        text = f"{value / 10.0**power:.4g}e{power}"
    return text.replace("e+0", "e").replace("e-0", "e-").replace("e+", "e")


@dataclass
class Series:
    """One line of a chart."""

    name: str
    x: Floats
    y: Floats
    colour: str = ""


@dataclass
class Axis:
    """From values to pixels."""

    low: float
    high: float
    start: float  #: pixel of low
    end: float
    is_log: bool = False
    is_whole: bool = False  #: ticks at whole numbers only

    def at(self, value: float) -> float:
        """The pixel of a value."""
        low, high, v = (math.log10(max(t, 1e-300)) for t in (self.low, self.high, value)) if self.is_log else (
            self.low, self.high, value)  # fmt: skip
        return self.start + (v - low) / ((high - low) or 1.0) * (self.end - self.start)

    def ticks(self) -> list[float]:
        """Round values."""
        if self.is_log:
            low, high = math.floor(math.log10(self.low)), math.ceil(math.log10(self.high))
            stride = max(1, (high - low) // 6)
            return [10.0**k for k in range(low, high + 1, stride) if self.low * 0.999 <= 10.0**k <= self.high * 1.001]
        span = self.high - self.low or 1.0
        step = 10 ** math.floor(math.log10(span / 4))
        step *= next(f for f in (1, 2, 5, 10) if span / (f * step) <= 6)
        step = max(step, 1.0) if self.is_whole else step
        first = math.ceil(self.low / step - 1e-9)
        return [k * step for k in range(first, math.floor(self.high / step + 1e-9) + 1)]


def frame(x: Axis, y: Axis, x_label: str, y_label: str) -> list[str]:
    """Grid, ticks and names of the axes."""
    parts = []
    for tick in y.ticks():
        at = y.at(tick)
        parts.append(f'<line class="grid" x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{at:.1f}" y2="{at:.1f}"/>')
        parts.append(f'<text class="tick" x="{LEFT - 6}" y="{at + 4:.1f}" text-anchor="end">{number(tick)}</text>')
    for tick in x.ticks():
        at = x.at(tick)
        parts.append(f'<line class="grid" x1="{at:.1f}" x2="{at:.1f}" y1="{TOP}" y2="{HEIGHT - BOTTOM}"/>')
        parts.append(f'<text class="tick" x="{at:.1f}" y="{HEIGHT - BOTTOM + 16}" text-anchor="middle">{number(tick)}</text>')
    parts.append(f'<text class="name" x="{(LEFT + WIDTH - RIGHT) / 2}" y="{HEIGHT - 6}" text-anchor="middle">{escape(x_label)}</text>')
    middle = (TOP + HEIGHT - BOTTOM) / 2
    parts.append(f'<text class="name" transform="translate(13 {middle}) rotate(-90)" text-anchor="middle">{escape(y_label)}</text>')
    return parts


def svg(parts: Sequence[str], label: str, width: float = WIDTH, height: float = HEIGHT) -> str:
    """The whole picture."""
    return (f'<svg class="chart" viewBox="0 0 {width:.0f} {height:.0f}" role="img" aria-label="{escape(label)}">'
            + "".join(parts) + "</svg>")  # fmt: skip


def lines(series: Sequence[Series], x_label: str, y_label: str, is_log: bool = False, marks: Sequence[float] = (),
          has_dots: bool = False) -> str:  # fmt: skip
    """A line per series; marks: x of vertical lines."""
    shown = [s for s in series if len(s.x)]
    if not shown:
        return '<p class="none">There is nothing to show.</p>'
    ys = np.concatenate([s.y for s in shown])
    ys = ys[np.isfinite(ys) & ((ys > 0) | (not is_log))]
    xs = np.concatenate([s.x for s in shown])
    if not len(ys):
        return '<p class="none">There is nothing to show.</p>'
    low, high = float(ys.min()), float(ys.max())
    if is_log:
        low, high = 10 ** math.floor(math.log10(low)), 10 ** math.ceil(math.log10(high) + 1e-9)
        high = high if high > low else 10 * low
    else:
        low, high = min(low, 0.0), max(high, 0.0)
        high = high if high > low else low + 1.0
    start = 0.0 if x_label == "time" else float(xs.min())
    x = Axis(start, float(xs.max()), LEFT, WIDTH - RIGHT)
    y = Axis(low, high, HEIGHT - BOTTOM, TOP, is_log)
    parts = frame(x, y, x_label, y_label)
    parts += [f'<line class="mark" x1="{x.at(m):.1f}" x2="{x.at(m):.1f}" y1="{TOP}" y2="{HEIGHT - BOTTOM}"/>' for m in marks]
    for i, s in enumerate(shown):
        colour = s.colour or COLOURS[i % len(COLOURS)]
        keep = np.isfinite(s.y) & ((s.y > 0) | (not is_log))
        places = [f"{x.at(a):.1f},{y.at(b):.1f}" for a, b in zip(s.x[keep], s.y[keep], strict=True)]
        parts.append(f'<polyline fill="none" stroke="{colour}" stroke-width="1.6" points="{" ".join(places)}"/>')
        if has_dots and len(places) <= 400:
            parts += [f'<circle cx="{p.split(",")[0]}" cy="{p.split(",")[1]}" r="2" fill="{colour}"/>' for p in places]
    return svg(parts, f"{y_label} over {x_label}") + legend([(s.name, s.colour or COLOURS[i % len(COLOURS)]) for i, s in enumerate(shown)])


def columns(names: Sequence[str], counts: NDArray, x_label: str, y_label: str, colours: Sequence[str]) -> str:
    """Stacked columns: counts (rows, names); many rows are joined by their largest."""
    counts = np.asarray(counts, dtype=float)
    if not len(counts) or counts.max() == 0:
        return '<p class="none">There is nothing to show.</p>'
    n = len(counts)
    chunk = max(1, math.ceil(n / 600))
    x = Axis(0.5, n + 0.5, LEFT, WIDTH - RIGHT, is_whole=True)
    y = Axis(0.0, float(counts.sum(axis=1).max()), HEIGHT - BOTTOM, TOP, is_whole=True)
    parts = frame(x, y, x_label, y_label)
    for start in range(0, n, chunk):
        rows = counts[start : start + chunk]
        row = rows[int(rows.sum(axis=1).argmax())]
        base = 0.0
        x0, x1 = x.at(start + 0.5), x.at(min(start + chunk, n) + 0.5)
        for value, colour in zip(row, colours, strict=False):
            if value > 0:
                top, bottom = y.at(base + value), y.at(base)
                parts.append(f'<rect x="{x0:.1f}" y="{top:.1f}" width="{max(x1 - x0 - 0.4, 0.4):.1f}" height="{bottom - top:.1f}" fill="{colour}"/>')
            base += value
    return svg(parts, f"{y_label} over {x_label}") + legend(list(zip(names, colours, strict=False)))


def legend(entries: Sequence[tuple[str, str]]) -> str:
    """Names with their colours."""
    items = "".join(f'<li><i style="background:{colour}"></i>{escape(name)}</li>' for name, colour in entries)
    return f'<ul class="legend">{items}</ul>'


def shade(value: float, low: float, high: float) -> str:
    """A colour of the scale."""
    t = min(max((value - low) / ((high - low) or 1.0), 0.0), 1.0) * (len(VIRIDIS) - 1)
    i = min(int(t), len(VIRIDIS) - 2)
    a, b = (tuple(int(VIRIDIS[k][j : j + 2], 16) for j in (1, 3, 5)) for k in (i, i + 1))
    return "#" + "".join(f"{round(p + (t - i) * (q - p)):02x}" for p, q in zip(a, b, strict=True))


def patches(polygons: Sequence[Floats], values: Sequence[float], title: str, unit: str, axes: tuple[str, str],
            classes: Sequence[tuple[str, str]] = ()) -> str:  # fmt: skip
    """Polygons in the plane in the colours of their values, or of classes (name, colour) by whole numbers."""
    if not len(polygons):
        return '<p class="none">There is nothing to show.</p>'
    places = np.concatenate(polygons)
    low, high = places.min(axis=0), places.max(axis=0)
    span = np.maximum(high - low, 1e-300)
    scale = min(330 / span[0], 330 / span[1])
    width, height = span * scale + 2
    parts = []
    top, bottom = max(values), min(values)
    bottom = min(bottom, 0.0) if top - bottom <= 1e-9 * abs(top) else bottom   # one value all over is the top of its scale
    for polygon, value in zip(polygons, values, strict=True):
        at = (polygon - low) * scale + 1
        colour = classes[min(round(value), len(classes) - 1)][1] if classes else shade(value, bottom, top)
        text = " ".join(f"{x:.1f},{height - y:.1f}" for x, y in at)
        parts.append(f'<polygon points="{text}" fill="{colour}" stroke="{colour}" stroke-width=".4"/>')
    picture = svg(parts, title, width, height)
    key = legend(classes) if classes else scale_bar(bottom, top)
    note = f'<p class="note">{escape(axes[0])} to the right, {escape(axes[1])} up</p>'
    return f'<figure class="map"><figcaption>{escape(title)} {escape(unit)}</figcaption>{picture}{key}{note}</figure>'


def scale_bar(low: float, high: float) -> str:
    """The colours with the values at their ends."""
    stops = ", ".join(VIRIDIS)
    return (f'<div class="scale"><span>{number(low)}</span><i style="background:linear-gradient(to right, {stops})"></i>'
            f"<span>{number(high)}</span></div>")  # fmt: skip
