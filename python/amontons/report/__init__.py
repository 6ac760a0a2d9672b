"""One self-contained HTML page of a job: amontons-report job.vtkhdf [--output job.html].

The page holds all that it shows (no server, no network): model, deck, convergence, slip scenarios, forces and energies,
contact maps, a view of the deformed bodies to turn with the mouse, and the nodes with the largest values.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import base64
import json
import math
import shutil
import subprocess
import sys
from collections.abc import Sequence
from html import escape
from pathlib import Path

import numpy as np

from amontons.report import charts, sections
from amontons.report.data import Floats, Job, read_job

__all__ = ["main", "make_report"]

HERE = Path(__file__).resolve().parent
#: The browser itself lets the page load nothing.
POLICY = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:"
MAX_BYTES = 24_000_000  #: of fields in the page; of longer jobs every n-th frame is shown
#: Fields of the view: name, field of the file, and how a number is made of it.
VIEWS = [
    ("Mises stress", "S_mises", "value"), ("displacement", "U", "length"), ("contact pressure", "CPRESS", "value"),
    ("friction", "CSHEAR", "length"), ("slip", "CSLIP", "length"), ("status (-1 no slave, 0 open, 1 stick, 2 slip)", "CSTATUS", "value"),
    ("plastic strain", "PEEQ", "value"), ("temperature", "NT", "value"),
]  # fmt: skip


def packed(values: np.ndarray, kind: str) -> str:
    """Numbers as text for the page; kind: f4 or u4, little endian."""
    return base64.b64encode(np.ascontiguousarray(values, dtype=f"<{kind}").tobytes()).decode()


def chosen_frames(n_frames: int, bytes_each: int) -> list[int]:
    """The frames that are shown: all, or evenly some with the last."""
    most = max(2, MAX_BYTES // max(bytes_each, 1))
    if n_frames <= most:
        return list(range(n_frames))
    return sorted({round(v) for v in np.linspace(0, n_frames - 1, most)})


def round_factor(job: Job) -> float:
    """1, or 1, 2, 5 times a power of ten that shows the largest displacement as about a tenth of the model.

    Where slave nodes start apart from their masters it is 1: larger displacements would show bodies in each other.
    """
    size = float(np.ptp(job.points, axis=0).max())
    if len(job.slave_node) and "COPEN" in job.fields and np.abs(job.fields["COPEN"][0][job.slave_node]).max() > 1e-6 * size:
        return 1.0
    largest = float(np.linalg.norm(job.fields["U"], axis=2).max())
    wanted = size / 10 / largest if largest > 0 else 1.0
    if wanted <= 2:
        return 1.0
    power = 10.0 ** math.floor(math.log10(wanted))
    return power * max(v for v in (1, 2, 5) if v * power <= wanted * 1.0000001)


def view_data(job: Job) -> dict[str, object]:
    """What the view draws: the outer nodes with their displacements and values."""
    triangles, sides = job.skin.triangles(), job.skin.edges()
    is_tool = (job.labels[triangles] == 0).all(axis=1)   # points of analytic surfaces have no labels
    triangles = np.concatenate([triangles[~is_tool], triangles[is_tool]])
    sides = sides[(job.labels[sides] > 0).any(axis=1)]
    edges = np.concatenate([sides, job.lines])
    nodes = np.unique(np.concatenate([triangles.ravel(), edges.ravel()]))
    place = np.zeros(len(job.points), dtype=np.int64)
    place[nodes] = np.arange(len(nodes))
    fields = [(name, source, how) for name, source, how in VIEWS if source in job.fields and (how == "length" or np.any(job.fields[source]))]
    fields = [entry for entry in fields if entry[1] in ("U", "S_mises") or np.any(job.fields[entry[1]])]
    frames = chosen_frames(len(job.times), 4 * len(nodes) * (3 + len(fields)))

    def scalar(source: str, how: str) -> Floats:
        values = job.fields[source][frames][:, nodes]
        return np.linalg.norm(values, axis=2) if how == "length" else values

    x = job.points[nodes] if len(nodes) else np.zeros((1, 3))
    middle = (x.min(axis=0) + x.max(axis=0)) / 2
    factor = round_factor(job)
    reach = max(float(np.linalg.norm(x + factor * job.fields["U"][k][nodes] - middle, axis=1).max()) for k in frames) if len(nodes) else 1.0
    return {
        "points": packed(x, "f4"), "triangles": packed(place[triangles], "u4"), "edges": packed(place[edges], "u4"),
        "nodes": packed(nodes, "u4"), "n_sides": len(sides), "n_bodies": int(np.sum(~is_tool)), "labels": job.labels[nodes].tolist(),
        "displacement": packed(job.fields["U"][frames][:, nodes], "f4"), "times": job.times[frames].tolist(), "frames": frames,
        "fields": [{"name": n, "unit": job.units.get(s, ""), "data": packed(scalar(s, h), "f4")} for n, s, h in fields],
        "middle": middle.tolist(), "radius": reach or 1.0,
        "factor": factor, "colours": charts.VIRIDIS, "view": "z" if job.is_plane else "iso",
    }  # fmt: skip


VIEW = """<div id="view"><div class="bar"><label>colour <select id="field"></select></label>
<label><input type="range" id="frame" min="0" step="1"></label><button id="play">play</button><span id="time"></span>
<label>displacements times <input type="number" id="factor" step="any"></label>
<label><input type="checkbox" id="edges" checked> edges</label><label><input type="checkbox" id="all"> colours of all frames</label>
<span><button data-view="iso">3D</button> <button data-view="x">x</button> <button data-view="front">y</button> <button data-view="z">z</button></span></div>
<canvas></canvas><p id="nogl" class="none" hidden>This browser has no WebGL 2; the rest of the page needs none.</p>
<div class="bar"><div class="scale"><span id="low"></span><i style="background:linear-gradient(to right, %s)"></i><span id="high"></span>
<span id="unit"></span></div><span id="chosen"></span></div></div>
<p class="note">Drag: turn. Shift and drag, or the right button: move. Wheel: nearer and farther. Click: choose a node.</p>"""


def make_report(job: Job, cards: str = "") -> str:
    """The page. cards: what `amontons --cards` prints, if the program is at hand."""
    is_done, sentence = sections.verdict(job)
    parts = [
        ("model", "Model", sections.model_summary(job)),
        ("view3d", "Deformed bodies", VIEW % ", ".join(charts.VIRIDIS)),
        ("contact", "Contact at the last frame", sections.maps(job)),
        ("ledger", "Forces and energies", sections.ledger(job)),
        ("convergence", "Convergence", sections.convergence(job)),
        ("scenarios", "Slip scenarios", sections.scenarios(job)),
        ("worst", "Largest values at the last frame", sections.worst_nodes(job)),
        ("deck", "The deck, card by card", sections.honesty(job, cards)),
    ]
    style, script = ((HERE / name).read_text() for name in ("page.css", "viewer.js"))
    data = json.dumps(view_data(job)).replace("</", "<\\/")
    links = "".join(f'<a href="#{name}">{escape(title)}</a>' for name, title, _ in parts)
    body = "".join(f'<section id="{name}"><h2>{escape(title)}</h2>{text}</section>' for name, title, text in parts)
    first_lines = escape("\n".join(job.deck.splitlines()[:400]))
    heading = f'<p class="soft">{escape(job.heading)}</p>' if job.heading else ""
    return (f'<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'
            f'<meta http-equiv="Content-Security-Policy" content="{POLICY}"><link rel="icon" href="data:,"><title>{escape(job.name)} - Amontons</title><style>{style}</style></head><body>'
            f'<header><h1>{escape(job.name)}</h1>{heading}<p class="{"done" if is_done else "open"}">{escape(sentence)}</p></header>'
            f"<nav>{links}</nav><main>{body}<details><summary>The deck (its first 400 lines)</summary><pre>{first_lines}</pre></details></main>"
            f'<script type="application/json" id="job">{data}</script><script>{script}</script></body></html>\n')  # fmt: skip


def explained_cards(program: str | None) -> str:
    """What `amontons --cards` prints; nothing if the program is not there."""
    places = [program, shutil.which("amontons"), str(HERE.parents[2] / "bin" / "amontons")]
    for place in places:
        if place and Path(place).exists():
            done = subprocess.run([place, "--cards"], capture_output=True, text=True, timeout=60, check=False)
            return done.stdout if done.returncode == 0 else ""
    return ""


def main(arguments: Sequence[str] | None = None) -> int:
    """The command line."""
    parser = argparse.ArgumentParser(prog="amontons-report", description="One self-contained HTML page of a job.")
    parser.add_argument("result", type=Path, help="job.vtkhdf")
    parser.add_argument("--output", type=Path, help="default: job.html beside it")
    parser.add_argument("--program", help="the program amontons, which explains each card (default: the one on the PATH)")
    wanted = parser.parse_args(arguments)
    path = wanted.result if wanted.result.suffix else wanted.result.with_suffix(".vtkhdf")
    try:
        job = read_job(path)
    except (OSError, ValueError) as error:
        print(f"*ERROR: {error}", file=sys.stderr)
        return 7
    output = wanted.output or path.with_suffix(".html")
    page = make_report(job, explained_cards(wanted.program))
    whole = output.with_name(output.name + ".new")  # an old page stays until the new one is whole
    try:
        whole.write_text(page, encoding="utf-8")
        whole.replace(output)
    except OSError as error:
        whole.unlink(missing_ok=True)
        print(f"*ERROR: The report {output} cannot be written: {error.strerror}.", file=sys.stderr)
        return 7
    print(f"The report is {output} ({output.stat().st_size / 1e6:.1f} MB).")
    return 0
