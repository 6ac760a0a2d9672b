"""The sections of the report: each a function from the job to HTML.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from html import escape

import numpy as np
from numpy.typing import NDArray

from amontons.report import charts
from amontons.report.charts import Series, number
from amontons.report.data import Floats, Ints, Job

SEARCHES = ["none", "all", "global", "nodal", "automatic"]
SCENARIOS = ["I slipped too far", "II not enough slip", "III backed up too far", "IV backing up"]
SCENARIO_COLOURS = ["#4daf7c", "#f2c14e", "#d1495b", "#6c5b9e"]
STATUS_NAMES = ["open", "stick", "slip"]
#: Cards that may follow *MATERIAL.
OF_MATERIALS = {"ELASTIC", "PLASTIC", "CYCLIC HARDENING", "CREEP", "HYPERELASTIC", "HYPERFOAM", "EXPANSION", "DENSITY", "CONDUCTIVITY",
                "SPECIFIC HEAT", "DEPVAR", "USER MATERIAL", "DAMPING", "DEFORMATION PLASTICITY", "POTENTIAL", "RATE DEPENDENT",
                "INITIAL CONDITIONS", "NO COMPRESSION", "VISCOELASTIC", "ANNEAL TEMPERATURE"}  # fmt: skip
#: Columns of the history in the table of energies: the first is the sum of the others.
ENERGIES = {"external_work": "external work", "strain_energy": "strain energy", "friction_work": "friction", "contact_energy": "stored in contact",
            "plastic_work": "plastic and creep", "damped_work": "damping", "proximal_work": "unbalanced steps",
            "kinetic_energy": "kinetic", "integration_loss": "backward Euler"}  # fmt: skip
UNTOLD = 1.0e29  #: written for what was no finite number


def table(head: Sequence[str], rows: Iterable[Sequence[object]], kind: str = "") -> str:
    """A table; cells that are numbers stand to the right. A cell that starts with < is HTML."""
    lines = [f'<div class="wide"><table class="{kind}"><thead><tr>' + "".join(f"<th>{escape(h)}</th>" for h in head) + "</tr></thead><tbody>"]
    for row in rows:
        cells = []
        for value in row:
            if isinstance(value, (float, np.floating)):
                cells.append(f'<td class="n">{number(float(value))}</td>')
            elif isinstance(value, (int, np.integer)):
                cells.append(f'<td class="n">{value}</td>')
            else:
                text = str(value)
                cells.append(f"<td>{text if text.startswith('<') else escape(text)}</td>")
        lines.append("<tr>" + "".join(cells) + "</tr>")
    return "".join(lines) + "</tbody></table></div>"


def verdict(job: Job) -> tuple[bool, str]:
    """Whether the job is done, in a sentence."""
    requested = float(np.sum(job.steps["period"]))
    done = float(job.times[-1]) if len(job.times) else 0.0
    rows = job.attempts()
    failed = int(np.sum(job.history["is_converged"][rows] == 0))
    reached = float(np.max(job.history["total_time"][rows & (job.history["is_converged"] == 1)], initial=0.0))
    if reached >= requested * (1 - 1e-9):
        n = len(job.steps["period"])
        steps = "The step is done" if n == 1 else f"All {n} steps are done"
        attempts = "no attempt was" if failed == 0 else "1 attempt was" if failed == 1 else f"{failed} attempts were"
        return True, f"{steps}, to time {number(reached)}; {attempts} cut back."
    reason = next((str(r) for r in reversed(job.history["reason"].tolist()) if str(r)), "") if "reason" in job.history else ""
    return False, f"The job is at time {number(max(reached, done))} of {number(requested)}. {reason}"


def model_summary(job: Job) -> str:
    """Sizes, kinds, materials, pairs, steps."""
    low, high = job.points.min(axis=0), job.points.max(axis=0)
    kinds = ", ".join(f"{n} {kind}" for kind, n in Counter(job.kinds).most_common())
    rows = [
        ("Nodes", f"{len(job.points)}"),
        ("Elements", kinds),
        ("Box", " x ".join(number(float(v)) for v in high - low) + f" from ({', '.join(number(float(v)) for v in low)})"),
        ("Slave nodes", f"{len(np.unique(job.slave_node))}"),
        ("Increments", f"{int(np.sum(job.history['is_converged'][job.attempts()]))} converged, {len(job.times)} frames on file (the initial state is one)"),
        ("Dialect, version", f"{job.dialect}, Amontons {job.version}"),
    ]
    parts = [table(("what", "value"), rows, "facts")]
    m = job.materials
    laws = material_cards(job.deck)
    parts.append("<h3>Materials</h3>" + table(
        ("material", "its cards", "Young's modulus", "Poisson's ratio", "density"),
        ((str(name), laws.get(str(name).upper(), "in an included file"), *(printed(float(m[part][i])) for part in ("youngs_modulus", "poissons_ratio", "density")))
         for i, name in enumerate(m["name"]))))  # fmt: skip
    p = job.pairs
    if len(p["slave"]):
        parts.append("<h3>Contact pairs</h3>" + table(
            ("slave", "master", "friction", "sliding", "slave nodes"),
            ((s, t, float(mu), "small" if small else "finite", int(np.sum(job.slave_pair == i)))
             for i, (s, t, mu, small) in enumerate(zip(p["slave"], p["master"], p["friction"], p["is_small_sliding"], strict=True)))))  # fmt: skip
    return "".join(parts)


def printed(value: float) -> object:
    """A number; 0 means that it is not given."""
    return value or "-"


def material_cards(deck: str) -> dict[str, str]:
    """The cards of each material, by its name."""
    found: dict[str, list[str]] = {}
    name = ""
    for line in deck.splitlines():
        if not line.startswith("*") or line.startswith("**"):
            continue
        card, *rest = (part.strip().upper() for part in line[1:].split(","))
        if card == "MATERIAL":
            name = next((part.split("=")[1].strip().strip('"') for part in rest if part.startswith("NAME")), "")
            found[name] = []
        elif card in OF_MATERIALS and name:
            found[name].append(", ".join([card, *(part for part in rest if part.startswith(("TYPE", "HARDENING", "LAW")) or "=" not in part)]))
        else:
            name = ""
    return {name: "; ".join(cards) or "none" for name, cards in found.items()}


def deck_cards(text: str) -> Counter[str]:
    """How often each card occurs in the deck."""
    found: Counter[str] = Counter()
    for line in text.splitlines():
        match = re.match(r"\*([A-Za-z][^,*]*)", line.strip())
        if match and not line.strip().startswith("**"):
            found[re.sub(r"\s+", " ", match.group(1).strip().upper())] += 1
    return found


def read_card_table(text: str) -> dict[str, tuple[str, str]]:
    """Card to (status, sentence) from what `amontons --cards` prints."""
    result: dict[str, tuple[str, str]] = {}
    name = ""
    for line in text.splitlines():
        head = re.match(r"\*([A-Z][A-Z0-9 -]*?)  \((.*)\)$", line)
        if head:
            name = head.group(1)
            continue
        group = re.match(r"(No effect|Refused|refused|no effect)[^:]*: (.*)", line)
        if group:
            name = ""
        if line.strip() and name and name not in result:
            result[name] = ("used", line.strip())
    return result


def honesty(job: Job, cards: str) -> str:
    """Every card of the deck: used or without effect; then the numbers that were taken."""
    known = read_card_table(cards)
    rows = []
    for card, count in sorted(deck_cards(job.deck).items()):
        status, sentence = known.get(card, ("", ""))
        if known and not status:
            status, sentence = "no effect", "Accepted; it cannot change the solution."
        rows.append((f"*{card}", count, f'<b class="{"good" if status == "used" else "quiet"}">{status or "accepted"}</b>', sentence))
    text = table(("card", "times", "status", "what it does"), rows)
    if not known:
        text += ('<p class="note">The program was not found, so the table only lists the cards: name it by '
                 "<code>--program</code>. Cards that are not supported end a job before it starts.</p>")  # fmt: skip
    s = job.steps
    text += "<h3>Steps, as they were taken</h3>" + table(
        ("step", "title", "geometry", "period", "first dt", "least dt", "largest dt", "most increments", "line search"),
        ((i + 1, str(s["title"][i]), "finite" if s["is_nlgeom"][i] else "linear", float(s["period"][i]), float(s["dt_initial"][i]),
          float(s["dt_min"][i]), float(s["dt_max"][i]), int(s["max_increments"][i]), SEARCHES[int(s["line_search"][i])])
         for i in range(len(s["period"]))))  # fmt: skip
    names = [n for n in ("r_n", "c_n", "r_p", "r_l", "s_max", "s_min", "gap_tolerance", "i_0", "i_r", "i_p", "i_c", "i_l", "i_g",
                         "i_a", "d_f", "d_c", "d_b", "d_d") if n in job.controls]  # fmt: skip
    text += "<h3>Controls, as they were taken</h3>" + table(
        ("step", *names), ((i + 1, *(job.controls[n][i].item() for n in names)) for i in range(len(s["period"]))))
    return text


def convergence(job: Job) -> str:
    """Residual and correction over the iterations, iterations per increment, and the attempts that failed."""
    it = job.iterations
    count = np.arange(1, len(it["residual"]) + 1, dtype=float)
    starts = count[np.asarray(it["iteration"]) == 1] - 0.5
    good = np.asarray(it["residual"]) < UNTOLD
    series = [Series("largest imbalance over largest force", count[good], np.asarray(it["residual"])[good])]
    good = np.asarray(it["correction"]) < UNTOLD
    series.append(Series("largest correction over largest increment", count[good], np.asarray(it["correction"])[good]))
    text = charts.lines(series, "Newton iteration, all steps", "relative size", is_log=True, marks=starts[:200], has_dots=len(count) < 150)
    rows = job.attempts()
    h = {name: column[rows] for name, column in job.history.items() if getattr(column, "shape", ())}
    good = np.asarray(h["is_converged"]) == 1
    total = int(np.sum(h["n_iterations"]))
    each = f"{counted(total, 'iteration')}, {total / int(good.sum()):.2f} per increment" if good.any() else counted(total, "iteration")
    text += (f"<p>{counted(int(good.sum()), 'increment')}, {counted(int((~good).sum()), 'attempt')} that failed, {each}; "
             f"{counted(int(np.sum(h['n_factorisations'])), 'factorisation')}, "
             f"{counted(int(np.sum(h['n_krylov'])), 'Krylov iteration')}.</p>")  # fmt: skip
    text += charts.columns(["iterations that converged", "iterations that failed"],
                           np.stack([h["n_iterations"] * good, h["n_iterations"] * ~good], axis=1), "attempt", "iterations",
                           ["#2166ac", "#d1495b"])  # fmt: skip
    bad = np.flatnonzero(~good)
    if len(bad):
        text += "<h3>Attempts that failed</h3>" + table(
            ("step", "increment", "attempt", "time", "dt", "iterations", "why"),
            ((int(h["step"][i]), int(h["increment"][i]), int(h["attempt"][i]), float(h["total_time"][i]), float(h["dt"][i]),
              int(h["n_iterations"][i]), str(h["reason"][i])) for i in bad[:60]))  # fmt: skip
    if len(bad) and not good[-1]:
        text += '<p class="note">The terminal shows the worst nodes and a remedy; the page "Messages" of the manual has a paragraph on each reason.</p>'
    return text


def counted(n: int, what: str) -> str:
    """How many, in words: no increment, 1 increment, 2 increments."""
    return f"no {what}" if n == 0 else f"1 {what}" if n == 1 else f"{n} {what}s"


def scenarios(job: Job) -> str:
    """Scenario and status counts over the iterations."""
    if not len(job.slave_node):
        return '<p class="none">The job has no contact pair.</p>'
    it = job.iterations
    text = charts.columns(SCENARIOS, np.asarray(it["n_scenario"]), "Newton iteration, all steps", "slave nodes", SCENARIO_COLOURS)
    text += charts.columns(STATUS_NAMES, np.asarray(it["n_status"]), "Newton iteration, all steps", "slave nodes", charts.STATUS)
    return text


def ledger(job: Job) -> str:
    """Forces and energies at the end of each step, and over time."""
    rows = job.attempts() & (job.history["is_converged"] == 1)
    h = {name: column[rows] for name, column in job.history.items() if getattr(column, "shape", ())}
    if not len(h["step"]):
        return '<p class="none">No increment has converged.</p>'
    last = [int(np.flatnonzero(h["step"] == s)[-1]) for s in np.unique(h["step"])]
    is_round = bool(job.kinds) and all(kind.startswith("CAX") for kind in job.kinds)
    counted = [1] if is_round else [0, 1, 2]   # around an axis radial forces balance by themselves
    nodal = float(np.linalg.norm(job.fields["RF"][-1], axis=1).max()) if "RF" in job.fields else 0.0
    lines = []
    for i in last:
        forces = [np.asarray(h[name][i]) for name in ("applied_force", "reaction_force", "contact_force")]
        rest = sum(forces)[counted]
        size = max(nodal, *(float(np.linalg.norm(f)) for f in (*forces, np.asarray(h["slave_force"][i]))))
        sums = [vector(np.asarray(f), size) for f in (*forces, h["slave_force"][i])]
        lines.append((int(h["step"][i]), float(h["total_time"][i]), *sums, float(np.linalg.norm(rest) / size) if size else 0.0))
    text = "<h3>Sums of forces at the end of each step</h3>" + table(
        ("step", "time", "applied", "reactions", "contact, slaves and masters", "contact on slaves", "imbalance over the largest"), lines)
    text += ('<p class="note">Supports that push against each other, and slaves against masters, add up to nothing. '
             + ("Around an axis only forces along the axis are counted in the imbalance. " if is_round else "") + "The largest is that of "
             "these sums, or of the reactions of single nodes.</p>" + by_set(job))  # fmt: skip
    work = [np.asarray(h[name], dtype=float) for name in ENERGIES]
    text += "<h3>Energy at the end of each step</h3>" + table(
        ("step", "time", *ENERGIES.values(), "the rest"),
        ((int(h["step"][i]), float(h["total_time"][i]), *(float(w[i]) for w in work),
          printed_zero(float(work[0][i] - sum(w[i] for w in work[1:])), max(abs(float(w[i])) for w in work))) for i in last))  # fmt: skip
    text += ('<p class="note">External work is the sum of the other columns. Unbalanced steps are those that moved a body without support '
             "into contact, or through a snap-through: in motion their work would be kinetic energy. The rest is the error of the trapezoidal "
             "rule by which external work is summed, and the work of CONTACT INTERFERENCE.</p>")  # fmt: skip
    n = int(job.times[0] == 0)   # nothing has happened at time 0
    time = np.concatenate([np.zeros(n), np.asarray(h["total_time"], dtype=float)])
    text += charts.lines([Series(name, time, np.concatenate([np.zeros(n), w])) for name, w in zip(("external work", "strain energy", "friction"), work, strict=False)],
                         "time", "energy")  # fmt: skip
    slave = np.concatenate([np.zeros((n, 3)), np.asarray(h["slave_force"])])
    names = "xyz"
    shown = [Series(f"contact on slaves, {names[k]}", time, slave[:, k]) for k in range(3) if np.abs(slave[:, k]).max() > 1e-9 * max(np.abs(slave).max(), 1e-300)]
    if not shown:
        sums = set_reactions(job)
        largest = max((float(np.abs(f).max()) for f in sums.values()), default=0.0)
        shown = [Series(f"{name}, {names[k]}", job.times, force[:, k]) for name, force in list(sums.items())[:3]
                 for k in range(3) if np.abs(force[:, k]).max() > 1e-6 * largest]  # fmt: skip
    return text + charts.lines(shown, "time", "force")


def set_reactions(job: Job) -> dict[str, Floats]:
    """Sums of the reactions over time of the node sets that are held: (frames, 3) each, the largest first."""
    if "RF" not in job.fields:
        return {}
    force = job.fields["RF"]
    nodal = float(np.linalg.norm(force, axis=2).max())
    sums = {name: force[:, members].sum(axis=1) for name, members in job.node_sets.items() if len(members) and len(members) < len(job.labels)}
    sums = {name: f for name, f in sums.items() if nodal > 0 and np.abs(f).max() > 1e-6 * nodal}
    return dict(sorted(sums.items(), key=lambda entry: -float(np.linalg.norm(entry[1], axis=1).max())))


def by_set(job: Job) -> str:
    """Reactions of the node sets that are held, at the last frame."""
    rows = [(name, len(job.node_sets[name]), *(printed_zero(float(v), float(np.abs(f).max())) for v in f[-1])) for name, f in set_reactions(job).items()]
    if not rows:
        return ""
    note = '<p class="note">Twelve sets with the largest.</p>' if len(rows) > 12 else ""
    return "<h3>Reactions of the node sets at the last frame</h3>" + table(("set", "nodes", "x", "y", "z"), rows[:12]) + note


def printed_zero(value: float, size: float) -> float:
    """Rounding beside a size is 0."""
    return value if abs(value) > 1e-9 * size else 0.0


def vector(value: Floats, size: float) -> str:
    """Three numbers; beside a size those of rounding are 0."""
    return "(" + ", ".join(number(float(v)) if abs(v) > 1e-12 * size else "0" for v in value) + ")"


def maps(job: Job) -> str:
    """Pressure, friction, slip and status on the slave side of each pair at the last frame."""
    if not len(job.slave_node):
        return '<p class="none">The job has no contact pair.</p>'
    if job.times[-1] == 0:
        return '<p class="none">No increment has converged: only the initial state is on file.</p>'
    text = pair_sums(job)
    for i in range(len(job.pairs["slave"])):
        nodes = np.unique(job.slave_node[job.slave_pair == i])
        if len(nodes):
            text += f"<h3>{escape(str(job.pairs['slave'][i]))} on {escape(str(job.pairs['master'][i]))}</h3>" + pair_maps(job, nodes, i)
    return text


def pair_sums(job: Job) -> str:
    """Forces of each pair: forces, area and centre at the last increment, and the sizes of the forces over time."""
    h = job.pair_history
    if not h or not len(h["pair"]):
        return ""
    names = [f"{slave} on {master}" for slave, master in zip(job.pairs["slave"], job.pairs["master"], strict=True)]
    largest = max(float(np.abs(h[key]).max()) for key in ("CFN", "CFS"))
    turning = max(float(np.abs(h[key]).max()) for key in ("CMN", "CMS"))
    rows, curves = [], []
    for i, name in enumerate(names):
        mine = np.flatnonzero(h["pair"] == i)
        if not len(mine):
            continue
        k = mine[-1]
        size = float(np.abs(job.points).max())
        rows.append((name, " / ".join(str(int(n)) for n in h["n_status"][k]), vector(h["CFN"][k], largest), vector(h["CFS"][k], largest),
                     vector(h["CMN"][k] + h["CMS"][k], turning), float(h["CAREA"][k]), vector(h["XN"][k], size)))
        for key, what in (("CFN", "pressure"), ("CFS", "friction")):
            over_time = np.linalg.norm(h[key][mine], axis=1)
            if len(curves) < 6 and over_time.max() > 1e-9 * largest:
                curves.append(Series(f"{name}, {what}", h["total_time"][mine], over_time))
    text = "<h3>Forces of each pair</h3>" + table(
        ("pair", "open / stick / slip", "force of the pressure on the slave", "of the friction", "moment about the origin", "area in contact",
         "centre of the pressure"), rows)
    return text + (charts.lines(curves, "time", "size of the force") if curves else "")


def pair_maps(job: Job, nodes: Ints, pair: int) -> str:
    """The maps of one slave surface; of a plane model curves. Of a surface all around a body: where it is closed."""
    closed = np.unique(job.slave_node[(job.slave_pair == pair) & job.is_closed])
    last = {name: values[-1] for name, values in job.fields.items()}
    shear, slip = (np.linalg.norm(last[name], axis=1) for name in ("CSHEAR", "CSLIP"))
    is_slave = np.zeros(len(job.points), dtype=bool)
    is_slave[nodes] = True
    rings = [] if job.is_plane else [(r, c) for r, c in zip(job.skin.rings, job.skin.corners, strict=True) if is_slave[c].all()]
    if not rings:
        return pair_curves(job, nodes, closed, shear, slip)
    x = job.points

    def area(c: Ints) -> Floats:
        return np.cross(x[c[2]] - x[c[0]], x[c[-1]] - x[c[1]]) if len(c) == 4 else np.cross(x[c[1]] - x[c[0]], x[c[2]] - x[c[0]])

    areas = np.array([area(c) for _, c in rings])
    if np.linalg.norm(areas.sum(axis=0)) < 0.5 * np.linalg.norm(areas, axis=1).sum() and len(closed):
        touching = np.array([np.isin(c, closed).sum() for _, c in rings])
        direction = (touching[:, None] * areas).sum(axis=0)
        keep = (touching > 0) & (areas @ direction > 0.3 * np.linalg.norm(areas, axis=1) * np.linalg.norm(direction))
        if keep.any():
            rings, areas = [ring for ring, k in zip(rings, keep, strict=True) if k], areas[keep]
    normal = areas.sum(axis=0)
    dropped = int(np.argmax(np.abs(normal)))
    kept = [d for d in range(3) if d != dropped]
    rings = rings[:: max(1, len(rings) // 6000)]
    shapes = [x[ring][:, kept] for ring, _ in rings]
    names = ("xyz"[kept[0]], "xyz"[kept[1]])

    def mean(values: Floats) -> list[float]:
        return [float(values[ring].mean()) for ring, _ in rings]

    parts, status = node_parts(rings, shapes, np.isin(np.arange(len(x)), nodes), last["CSTATUS"])
    return ('<div class="maps">' + charts.patches(shapes, mean(last["CPRESS"]), "Pressure", job.units.get("CPRESS", ""), names)
            + charts.patches(shapes, mean(shear), "Friction", job.units.get("CSHEAR", ""), names)
            + charts.patches(shapes, mean(slip), "Slip since the start", job.units.get("CSLIP", ""), names)
            + charts.patches(parts, status, "Status", "", names, list(zip(STATUS_NAMES, charts.STATUS, strict=True))) + "</div>")  # fmt: skip


def node_parts(rings: Sequence[tuple[Ints, Ints]], shapes: Sequence[Floats], is_slave: NDArray[np.bool_], values: Floats) -> tuple[list[Floats], list[float]]:
    """Each slave node's part of the faces around it, from the middles of its sides to that of the face, and its value.

    Where only corners are slaves, the sides reach from corner to corner.
    """
    parts, found = [], []
    for (ring, corners), shape in zip(rings, shapes, strict=True):
        has_middles = bool(is_slave[ring].all())
        nodes, places = (ring, shape) if has_middles or len(ring) == len(corners) else (corners, shape[:: len(ring) // len(corners)])
        centre = places.mean(axis=0)
        for a, node in enumerate(nodes):
            after, before = (places[a] + places[(a + 1) % len(nodes)]) / 2, (places[a] + places[a - 1]) / 2
            parts.append(np.stack([places[a], after, centre, before]))
            found.append(float(values[node]))
    return parts, found


def pair_curves(job: Job, nodes: Ints, closed: Ints, shear: Floats, slip: Floats) -> str:
    """Curves along the direction in which the slave nodes reach farthest."""
    if 1 < len(closed) < 0.4 * len(nodes):   # local contact: what is near it
        x = job.points
        nearest = np.sort(np.linalg.norm(x[closed][:, None] - x[closed][None], axis=2), axis=1)[:, 1].max()
        apart = np.linalg.norm(x[nodes][:, None] - x[closed][None], axis=2).min(axis=1)
        nodes = nodes[apart < 2.5 * nearest]
    d = int(np.argmax(np.ptp(job.points[nodes], axis=0)))
    order = nodes[np.argsort(job.points[nodes, d], kind="stable")]
    at, pressure = job.points[order, d], job.fields["CPRESS"][-1]
    text = charts.lines([Series("pressure", at, pressure[order]), Series("friction", at, shear[order])], "xyz"[d], "stress", has_dots=True)
    return text + charts.lines([Series("slip since the start", at, slip[order])], "xyz"[d], "length", has_dots=True)


def worst_nodes(job: Job) -> str:
    """The nodes with the largest values at the last frame."""
    last = {name: values[-1] for name, values in job.fields.items()}
    sources: list[tuple[str, str, Callable[[], Floats]]] = [
        ("displacement", "U", lambda: np.linalg.norm(last["U"], axis=1)),
        ("Mises stress", "S_mises", lambda: last["S_mises"]),
        ("reaction", "RF", lambda: np.linalg.norm(last["RF"], axis=1)),
        ("contact pressure", "CPRESS", lambda: last["CPRESS"]),
        ("slip", "CSLIP", lambda: np.linalg.norm(last["CSLIP"], axis=1)),
        ("penetration", "COPEN", lambda: np.where(last["CSTATUS"] > 0, -last["COPEN"], 0.0)),
        ("plastic strain", "PEEQ", lambda: last["PEEQ"]),
    ]
    rows = []
    for name, source, values in sources:
        if source not in last:
            continue
        size = values()
        for rank, node in enumerate(np.argsort(-size, kind="stable")[:3], start=1):
            if size[node] > 0:
                place = ", ".join(number(float(v)) for v in job.points[node])
                button = f'<button class="node" data-node="{node}">{job.labels[node]}</button>'
                rows.append((name if rank == 1 else "", rank, button, float(size[node]), job.units.get(source, ""), place))
    return table(("what", "", "node", "value", "unit", "where it was at the start"), rows) + (
        '<p class="note">A click on a node shows it in the view. Stresses are those at the nodes, extrapolated from the '
        "integration points and averaged: at a singular corner they grow with every refinement.</p>")
