"""What two jobs of one model have in common: fields at all nodes and times, iterations of each step.

A model in other units is another one in the last digits of its coordinates, so no field is known better than these make it: see `rounding`.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import h5py
import numpy as np
from numpy.typing import NDArray

from verify.cases.proof import Job
from verify.independent.results import Floats
from verify.invariance.scaling import Units, cards, keyword
from verify.invariance.test_invariance import stress_back

Ints = NDArray[np.int64]
SYSTEMS = {"SI": Units(1e-3, 1.0), "m-kN": Units(1e-3, 1e-3), "inch-pound": Units(1 / 25.4, 0.22480894387096)}
#: Fields and their units, of models turned or numbered otherwise; and in other units all that a result file has at its nodes.
FIELDS = {"U": "L", "S": "S", "CPRESS": "S", "CNORMF": "F", "CSHEARF": "F"}
IN_UNITS = FIELDS | {"RF": "F", "E": "1", "LE": "1", "PEEQ": "1", "CSHEAR": "S", "COPEN": "L", "CSLIP": "L"}
#: Parts of one thing: the largest value of them all counts. RF holds the residual of the contact forces.
PARTS = {"CNORMF": ["CNORMF", "CSHEARF"], "CSHEARF": ["CNORMF", "CSHEARF"], "CPRESS": ["CPRESS", "CSHEAR"], "CSHEAR": ["CPRESS", "CSHEAR"],
         "COPEN": ["U"], "CSLIP": ["U"], "RF": ["RF", "CNORMF", "CSHEARF"]}  # fmt: skip


@dataclass
class View:
    """How to look at a job to see the plain one."""

    turn: Floats = field(default_factory=lambda: np.eye(3))
    label: dict[int, int] | None = None  #: the job's label of each node of the plain one

    def of(self, job: Job, plain: Job, name: str) -> Floats:
        """A field in the plain job's axes, node by node as `plain` has it."""
        values = job.field(name)[:, [*places(job, [(self.label or {}).get(label, label) for label in deck_labels(plain)]), *rotations(job)]]
        if name == "S":
            return stress_back(values, self.turn)
        return values @ self.turn if values.shape[-1] == 3 else values

    def plain(self, job: Job, name: str) -> Floats:
        """At the nodes of the deck in their order, then at those that bear the turning of a rigid body."""
        return job.field(name)[:, [*places(job, deck_labels(job)), *rotations(job)]]


@dataclass
class InUnits:
    """How to look at a job in other units; all nodes of the file are in the same order."""

    units: Units

    def of(self, job: Job, plain: Job, name: str) -> Floats:
        """A field in the plain job's units. Nodes that no cell is drawn with may bear angles and moments: the unit is the one that fits."""
        values = job.field(name) / self.units.of(IN_UNITS[name])
        if name in ("U", "RF"):
            expected, turned = plain.field(name), values * (self.units.length if name == "U" else 1 / self.units.length)
            fits = np.abs(turned - expected).max(axis=(0, 2)) < np.abs(values - expected).max(axis=(0, 2))
            fits &= ~np.isin(np.arange(len(fits)), drawn(job))
            values[:, fits] = turned[:, fits]
        return values

    def plain(self, job: Job, name: str) -> Floats:
        """As the file has it."""
        return job.field(name)


def drawn(job: Job) -> Ints:
    """The nodes of the cells of the result file."""
    with h5py.File(job.path) as file:
        return file["VTKHDF/Connectivity"][:]


def places(job: Job, wanted: list[int]) -> list[int]:
    """Where the result file has nodes."""
    place = {int(label): i for i, label in enumerate(labels(job))}
    return [place[label] for label in wanted]


def rotations(job: Job) -> list[int]:
    """Where the result file has the nodes that it adds to rigid bodies for their turning: the first ones behind those of the deck."""
    n = sum(card[0].upper().startswith("*RIGID BODY") for card in cards(deck_text(job)))
    behind = max(deck_labels(job))
    return places(job, [behind + 1 + i for i in range(n)])


def deck_text(job: Job) -> str:
    """What was run."""
    return job.path.with_suffix(".inp").read_text()


def deck_labels(job: Job) -> list[int]:
    """Of the nodes that the deck has; the program adds others, to turn rigid bodies and to draw analytic surfaces."""
    return [int(line.split(",")[0]) for card in cards(deck_text(job)) if keyword(card) == "NODE" for line in card[1:] if line.strip()]


def labels(job: Job) -> Floats:
    """Of the nodes of the result file."""
    with h5py.File(job.path) as file:
        return file["AMONTONS/mesh/node_label"][:]


def has(job: Job, name: str) -> bool:
    """Whether there is such a field: a job without contact has no pressure."""
    with h5py.File(job.path) as file:
        return name in file["VTKHDF/PointData"]


def rounding(job: Job) -> dict[str, float]:
    """What a change of all places by d, a few of their last digits, makes of fields: d of displacements and gaps, d over the shortest edge of strains, and
    with the stiffness of bodies and of springs of contact stresses and forces. Such a force moves the model by its compliance, the largest displacement
    over the largest load."""
    with h5py.File(job.path) as file:
        points, cells, firsts = (file[f"VTKHDF/{name}"][:] for name in ("Points", "Connectivity", "Offsets"))
        young, nu = (file[f"AMONTONS/materials/{name}"][:] for name in ("youngs_modulus", "poissons_ratio"))
        contact = {name: file[f"AMONTONS/contact/{name}"][:] for name in ("stiffness", "area")} if "AMONTONS/contact" in file else {}
    edges = np.linalg.norm(np.diff(points[cells], axis=0), axis=1)
    edges[firsts[1:-1] - 1] = 0.0   # from cell to cell
    size = float(np.ptp(points, axis=0).max() + np.abs(job.field("U")).max())
    d = 10 * np.finfo(float).eps * size
    shortest = edges[edges > 0].min(initial=size)
    strain = d / shortest + np.finfo(float).eps * max((np.abs(job.field(name)).max() for name in ("E", "LE") if has(job, name)), default=0.0)
    stiffness = float((young / (1 - 2 * np.minimum(nu, 0.4999))).max(initial=0.0))
    spring = float(contact["stiffness"].max(initial=0.0)) if contact else 0.0
    bed = float((contact["stiffness"] / np.maximum(contact["area"], shortest**2)).max(initial=0.0)) if contact else 0.0
    loads = max(np.abs(job.history[name]).max(initial=0.0) for name in ("applied_force", "reaction_force", "contact_force"))
    stress, force = stiffness * strain, 2 * np.pi * stiffness * strain * shortest * size + 10 * np.finfo(float).eps * loads   # around an axis
    moved = force * np.abs(job.field("U")).max() / loads if loads > 0 else 0.0
    return {"L": d + moved, "1": max(strain, bed * d / stiffness if stiffness > 0 else 0.0), "S": max(stress, bed * d), "F": max(force, spring * d)}


def same(job: Job, wanted: Job, tolerance: float, view: View | InUnits | None = None) -> None:
    """Fields of all frames, and iterations per step within one."""
    view = view or View()
    names = IN_UNITS if isinstance(view, InUnits) else FIELDS
    if isinstance(view, InUnits) and re.search(r"^\*SURFACE\b.*TYPE\s*=\s*NODE", deck_text(wanted), flags=re.I | re.M):
        names = {name: unit for name, unit in names.items() if name not in ("CPRESS", "CSHEAR")}   # forces there: a node without faces has the area 1
    assert job.times.shape == wanted.times.shape, "other increments"
    last_digits = rounding(wanted) if tolerance > 0 else {}
    for name in (name for name in names if has(wanted, name)):
        largest = max(np.abs(view.plain(wanted, other)).max() for other in PARTS.get(name, [name]) if has(wanted, other))
        allowed = tolerance * largest + last_digits.get(names[name], 0.0)
        worst = np.abs(view.of(job, wanted, name) - view.plain(wanted, name)).max()
        assert worst <= allowed, f"{name} differs by {worst:.1e}, allowed {allowed:.1e}; its largest value is {largest:.1e}"
    same_counts(job, wanted)


def same_counts(job: Job, wanted: Job) -> None:
    """Increments, and iterations per step within one."""
    assert job.times.shape == wanted.times.shape and np.allclose(job.times, wanted.times, rtol=1e-12), "other increments"
    for number in np.unique(wanted.history["step"]):
        counts = [int(j.history["n_iterations"][j.history["step"] == number].sum()) for j in (job, wanted)]
        assert abs(counts[0] - counts[1]) <= 1, f"iterations of step {number}: {counts[0]}, of the plain case {counts[1]}"
