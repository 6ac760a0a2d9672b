"""The check of contact, increment by increment, from displacements alone.

In equilibrium the force of contact on a slave node is its internal force (nothing else acts there). It is split along
the continuous normal of the master at the closest point and judged by the laws of Signorini and Coulomb; the forces
on the masters are the opposite ones with the weights of the closest points.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass, field

import numpy as np
from numpy.typing import NDArray

from . import element as kernel
from . import facets as geometry
from .deck import Deck, DeckError
from .results import Results

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class Tolerances:
    """Tolerances; each is relative to what its comment says."""

    friction: float = 1e-5  #: |t| - mu p, of the largest p
    penetration: float = 1e-8  #: of the mean edge of the master's facets
    tension: float = 1e-6  #: p < 0, of the largest p
    open_force: float = 1e-6  #: force on a node that does not touch, of the largest contact force
    balance: float = 1e-6  #: forces and moments of the bodies, of the sum of absolute forces
    stress: float = 1e-9  #: stresses on file against our own, of the largest
    equilibrium: float = 1e-5  #: imbalance of a node, of the largest nodal force
    direction: float = 1e-3  #: friction against slip, sine of the angle, for slips above a hundredth of the largest
    slip: float = 1e-8  #: a node slips if it moves by more than this times the mean edge


@dataclass
class PairCheck:
    """One pair in one increment."""

    pair: str
    n_open: int = 0
    n_stick: int = 0
    n_slip: int = 0
    normal_force: float = 0.0  #: sum of N [force]
    shear_force: float = 0.0  #: length of the sum of the tangential forces on the slave [force]
    largest_pressure: float = 0.0  #: [stress]
    friction: float = 0.0  #: worst |t| - mu p over the largest p
    unused: float = 0.0  #: worst mu p - |t| of a slipping node over the largest p
    direction: float = 0.0  #: worst sine between friction and minus slip
    penetration: float = 0.0  #: worst, over the mean facet edge
    tension: float = 0.0  #: worst -p over the largest p
    open_force: float = 0.0  #: worst force on an open node over the largest
    force_balance: float = 0.0  #: slave forces plus master forces over the sum of absolute slave forces
    moment_balance: float = 0.0  #: the same of moments, over that sum times the size of the pair


@dataclass
class IncrementCheck:
    """One increment."""

    frame: int
    step: int
    time: float
    pairs: list[PairCheck] = field(default_factory=list)
    equilibrium: float = 0.0  #: worst imbalance of a free node, master nodes with their share of contact
    body_force: float = 0.0  #: worst resultant of supports and contact on a body, over the sum of absolute forces
    body_moment: float = 0.0  #: the same of moments, over that sum times the body's size
    reactions: float = 0.0  #: worst difference between RF on file and our own, over the largest
    stress: float = 0.0  #: worst difference between the stresses on file and our own, over the largest
    failures: list[str] = field(default_factory=list)

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        return asdict(self)


class ContactCheck:
    """Judges all increments of a result file."""

    def __init__(self, deck: Deck, results: Results, tolerances: Tolerances | None = None) -> None:
        if deck.dialect != "abaqus" or results.dialect != "abaqus":
            raise DeckError("the independent element is the one of the abaqus dialect (mean dilatation, Hencky)")
        if any(step.is_loaded for step in deck.steps):
            raise DeckError("distributed loads: the independent check supports displacements and contact only")
        self.deck, self.results, self.tolerances = deck, results, tolerances or Tolerances()
        self.elastic = deck.elastic()
        self.bodies = deck.bodies()
        self.order = _match(deck, results)
        #: Forces below that of a strain of 1e-6 on a slave's facet are never a scale: nothing is loaded yet.
        edges = [_mean_edge(deck.nodes[deck.facets(deck.pairs[p].master)]) for p in range(len(deck.pairs))]
        self.smallest_force = 1e-6 * float(self.elastic[:, 0].max()) * min(edges, default=1.0) ** 2

    def run(self) -> Iterator[IncrementCheck]:
        """One verdict per increment on file."""
        before = self.deck.nodes + self.results.displacements[0][self.order]
        was_closed = {p: np.zeros(0, dtype=bool) for p in range(len(self.deck.pairs))}
        for frame in range(1, len(self.results.times)):
            time = float(self.results.times[frame])
            check = IncrementCheck(frame, self.deck.step_at(time) + 1, time)
            before, was_closed = self._increment(check, before, was_closed)
            self._judge(check)
            yield check

    def _increment(
        self, check: IncrementCheck, before: Floats, was_closed: dict[int, Flags]
    ) -> tuple[Floats, dict[int, Flags]]:
        deck, step = self.deck, self.deck.steps[check.step - 1]
        displacement = self.results.displacements[check.frame][self.order]
        now = deck.nodes + displacement
        state = kernel.element_state(
            deck.nodes[deck.elements], displacement[deck.elements], self.elastic, step.is_nlgeom
        )
        internal = kernel.nodal_forces(state, deck.elements, len(deck.nodes))
        check.stress = self._stress_difference(state, check.frame)
        is_free = _free(step.held, len(deck.nodes))
        contact = np.zeros_like(internal)
        closed = {}
        for p in range(len(deck.pairs)):
            verdict, force, closed[p] = self._pair(p, internal, is_free, before, now, was_closed[p], step.is_nlgeom)
            check.pairs.append(verdict)
            contact += force
        self._equilibrium(check, internal, contact, is_free, now if step.is_nlgeom else deck.nodes)
        return now, closed

    def _stress_difference(self, state: kernel.ElementState, frame: int) -> float:
        """Stresses at the integration points: those on file against those from the displacements."""
        if self.results.stresses is None or self.results.element_labels is None:
            return 0.0
        row = {int(label): i for i, label in enumerate(self.results.element_labels)}
        order = [row[int(label)] for label in self.deck.element_labels]
        on_file = self.results.stresses[frame].reshape(-1, 8, 6)[order]
        own = state.cauchy[..., [0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]]
        smallest_force = 1e-4 * float(self.elastic[:, 0].max())
        return float(np.abs(on_file - own).max()) / max(float(np.abs(own).max()), smallest_force)

    def _pair(
        self, p: int, internal: Floats, is_free: Flags, before: Floats, now: Floats, was_closed: Flags, is_nlgeom: bool
    ) -> tuple[PairCheck, Floats, Flags]:
        """One pair: verdict, contact force on all nodes, which slave nodes touch."""
        deck, pair = self.deck, self.deck.pairs[p]
        slaves, quads = deck.surface_nodes(pair.slave), deck.facets(pair.master)
        edge = _mean_edge(deck.nodes[quads])
        at = _locate(slaves, quads, deck.nodes, now, is_nlgeom)
        force = np.where(is_free, internal, 0.0)[slaves]
        along = np.einsum("ni,ni->n", force, at.normal)
        across = force - along[:, None] * at.normal
        is_closed = (np.abs(at.gap) <= 10 * self.tolerances.penetration * edge) & ~at.is_beside
        slip = _slip(slaves, quads, deck.nodes, before, now, at.normal, is_nlgeom)
        area = self._areas(pair.slave, slaves, now if is_nlgeom else deck.nodes)
        verdict = PairCheck(f"{pair.slave} / {pair.master}")
        mu = deck.friction[pair.interaction]
        is_old = was_closed if len(was_closed) == len(slaves) else is_closed
        self._friction_laws(verdict, mu, along, across, slip, area, is_closed, is_old, edge)
        self._touching(verdict, at, along, force, area, is_closed, edge)
        contact = np.zeros_like(internal)
        contact[slaves] = np.where(is_closed[:, None], force, 0.0)
        weights = geometry.shapes(at.xi)
        np.add.at(contact, quads[at.facet].ravel(), -(weights[:, :, None] * contact[slaves][:, None, :]).reshape(-1, 3))
        self._pair_balance(verdict, slaves, np.unique(quads), internal, is_free, now if is_nlgeom else deck.nodes)
        return verdict, contact, is_closed

    def _areas(self, surface: str, slaves: Ints, x: Floats) -> Floats:
        """Tributary areas; ones for a node-based surface."""
        if self.deck.surfaces[surface][0][1] == 0:
            return np.ones(len(slaves))
        return geometry.tributary_areas(slaves, self.deck.facets(surface), x)

    def _friction_laws(
        self,
        verdict: PairCheck,
        mu: float,
        along: Floats,
        across: Floats,
        slip: Floats,
        area: Floats,
        is_closed: Flags,
        is_old: Flags,
        edge: float,
    ) -> None:
        """Coulomb: |t| <= mu p; slipping nodes use all of it, against their slip. Counts of open, stick, slip."""
        pressure, shear = along / area, np.linalg.norm(across, axis=1) / area
        largest = max(float(np.abs(pressure).max(initial=0.0)), self.smallest_force / float(area.max()))
        excess = (shear - mu * np.maximum(pressure, 0.0)) / largest
        length = np.linalg.norm(slip, axis=1)
        is_slipping = is_closed & (length > self.tolerances.slip * edge)
        # A node that closed in this increment has its origin where it first touched: only its limit can be judged.
        is_slipping = np.where(is_old, is_slipping, is_closed & (excess > -self.tolerances.friction) & (mu > 0))
        verdict.n_open = int((~is_closed).sum())
        verdict.n_slip = int(is_slipping.sum())
        verdict.n_stick = int(is_closed.sum()) - verdict.n_slip
        verdict.normal_force = float(along[is_closed].sum())
        verdict.shear_force = float(np.linalg.norm(across[is_closed].sum(axis=0)))
        verdict.largest_pressure = largest
        verdict.friction = float(excess[is_closed].max(initial=0.0))
        verdict.unused = float((-excess)[is_slipping & is_old].max(initial=0.0))
        is_long = (length > 1e-2 * length.max(initial=0.0)) & (shear > 1e-3 * mu * largest) & (mu > 0)
        is_long &= is_slipping & is_old
        sine = np.linalg.norm(np.cross(geometry.unit(across[is_long]), geometry.unit(slip[is_long])), axis=1)
        is_with = np.einsum("ni,ni->n", across[is_long], slip[is_long]) > 0
        verdict.direction = float(np.where(is_with, 1.0, sine).max(initial=0.0))

    def _touching(
        self,
        verdict: PairCheck,
        at: geometry.Projection,
        along: Floats,
        force: Floats,
        area: Floats,
        is_closed: Flags,
        edge: float,
    ) -> None:
        """Signorini: no penetration, no tension, no force at a distance."""
        largest_force = max(float(np.abs(force).max(initial=0.0)), self.smallest_force)
        verdict.penetration = float((-at.gap / edge)[~at.is_beside].max(initial=0.0))
        verdict.tension = float((-along / area / verdict.largest_pressure)[is_closed].max(initial=0.0))
        verdict.open_force = float((np.linalg.norm(force, axis=1) / largest_force)[~is_closed].max(initial=0.0))

    def _pair_balance(
        self, verdict: PairCheck, slaves: Ints, masters: Ints, internal: Floats, is_free: Flags, x: Floats
    ) -> None:
        """What the slaves get and what the masters get, as internal forces: resultant and moment vanish.

        Held directions carry reactions that cannot be separated from contact: they are left out of both sums.
        """
        both = np.concatenate([slaves, masters])
        open_directions = ~((~is_free[both]).any(axis=0))
        force = np.where(open_directions, internal[both], 0.0)
        scale = max(float(np.abs(internal[slaves]).sum()), self.smallest_force)
        arm = x[both] - x[both].mean(axis=0)
        verdict.force_balance = float(np.linalg.norm(force.sum(axis=0)) / scale)
        if open_directions.all():
            size = float(np.ptp(x[both], axis=0).max())
            verdict.moment_balance = float(np.linalg.norm(np.cross(arm, force).sum(axis=0)) / (scale * size))

    def _equilibrium(self, check: IncrementCheck, internal: Floats, contact: Floats, is_free: Flags, x: Floats) -> None:
        """Free nodes have no force but contact; reactions and contact balance on each body."""
        reaction = np.where(is_free, 0.0, internal - contact)
        imbalance = np.where(is_free, contact - internal, 0.0)
        largest = max(float(np.abs(internal).max()), self.smallest_force)
        check.equilibrium = float(np.abs(imbalance).max() / largest)
        acting = reaction + contact
        scale = max(float(np.abs(acting).sum()) / 2, self.smallest_force)
        for body in range(self.bodies.max() + 1):
            inside = self.bodies == body
            place = x[inside] - x[inside].mean(axis=0)
            size = float(np.ptp(place, axis=0).max())
            force = float(np.linalg.norm(acting[inside].sum(axis=0))) / scale
            moment = float(np.linalg.norm(np.cross(place, acting[inside]).sum(axis=0))) / (scale * size)
            check.body_force, check.body_moment = max(check.body_force, force), max(check.body_moment, moment)
        if self.results.reactions is not None:
            on_file = self.results.reactions[check.frame][self.order]
            check.reactions = float(np.abs(np.where(is_free, 0.0, on_file - reaction)).max() / largest)

    def _judge(self, check: IncrementCheck) -> None:
        """Compares with the tolerances; names what fails."""
        t = self.tolerances
        limits = [("equilibrium", t.equilibrium), ("body_force", t.balance), ("body_moment", t.balance)]
        limits += [("reactions", t.equilibrium), ("stress", t.stress)]
        check.failures += _above(check, limits, "")
        for pair in check.pairs:
            limits = [("friction", t.friction), ("unused", t.friction), ("direction", t.direction)]
            limits += [("penetration", t.penetration), ("tension", t.tension), ("open_force", t.open_force)]
            limits += [("force_balance", t.balance), ("moment_balance", t.balance)]
            check.failures += _above(pair, limits, f" of {pair.pair}")


def _above(owner: object, limits: list[tuple[str, float]], where: str) -> list[str]:
    """Sentences for the quantities above their limits (NaN is above)."""
    values = [(name, getattr(owner, name), limit) for name, limit in limits]
    return [f"{name}{where} is {value:.2e}, allowed {limit:.0e}" for name, value, limit in values if not value <= limit]


def _match(deck: Deck, results: Results) -> Ints:
    """For each node of the deck its row in the file: by label, else in the deck's order; the places must agree."""
    if len(results.points) != len(deck.nodes):
        raise DeckError(f"the result file has {len(results.points)} points, the deck {len(deck.nodes)} nodes")
    order = np.arange(len(deck.nodes))
    if results.labels is not None:
        row = {int(label): i for i, label in enumerate(results.labels)}
        order = np.array([row[int(label)] for label in deck.labels])
    if not np.allclose(results.points[order], deck.nodes, rtol=0, atol=1e-12 * float(np.ptp(deck.nodes))):
        raise DeckError("the points of the result file are not the nodes of the deck")
    return order


def _free(held: dict[int, set[int]], n_nodes: int) -> Flags:
    """(n_nodes, 3) whether a degree of freedom is not held."""
    free = np.ones((n_nodes, 3), dtype=bool)
    for node, dofs in held.items():
        free[node, [d - 1 for d in dofs if d <= 3]] = False
    return free


def _mean_edge(corners: Floats) -> float:
    """Mean edge length of facets (n, 4, 3)."""
    return float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).mean())


def _locate(slaves: Ints, quads: Ints, reference: Floats, now: Floats, is_nlgeom: bool) -> geometry.Projection:
    """Where the slaves are; with small displacements facet, weights and normal are those of the reference."""
    if is_nlgeom:
        return geometry.project(now[slaves], quads, reference, now)
    at = geometry.project(reference[slaves], quads, reference, reference)
    at.point = geometry.facet_point(now[quads][at.facet], at.xi)
    at.gap = np.einsum("ni,ni->n", now[slaves] - at.point, at.normal)
    return at


def _slip(
    slaves: Ints, quads: Ints, reference: Floats, before: Floats, now: Floats, normal: Floats, is_nlgeom: bool
) -> Floats:
    """(n, 3) motion in this increment of the slave past the point of the master that it was over at its start."""
    start = before if is_nlgeom else reference
    origin = geometry.project(start[slaves], quads, reference, start)
    material = geometry.facet_point(now[quads][origin.facet], origin.xi)
    offset = now[slaves] - material
    if not is_nlgeom:
        offset -= before[slaves] - geometry.facet_point(before[quads][origin.facet], origin.xi)
    return offset - np.einsum("ni,ni->n", offset, normal)[:, None] * normal
