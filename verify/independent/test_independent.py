"""The checks are checked: element against its own energy, projections against known points, a state that is right and
states that are wrong.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.decks import make_decks
from verify.independent import element, facets
from verify.independent.contact import ContactCheck, IncrementCheck
from verify.independent.deck import DeckError, read_deck
from verify.independent.results import Results
from verify.tools import contact_check

VERIFY = Path(__file__).resolve().parents[1]


ELASTIC = np.array([[1000.0, 0.3]])


def distorted(seed: int, size: float) -> np.ndarray:
    """(1, 8, 3) a unit cube with its corners moved at random."""
    random = np.random.default_rng(seed)
    return ((element.CORNERS + 1.0) / 2 + size * random.uniform(-1, 1, (8, 3)))[None]


@pytest.mark.parametrize("is_nlgeom", [True, False])
def test_forces_are_the_gradient_of_the_energy(is_nlgeom: bool) -> None:
    """Central differences of the energy, step 1e-5: truncation and rounding leave about 1e-9."""
    corners, u = distorted(1, 0.15), distorted(2, 0.2) - distorted(3, 0.0)
    forces = element.element_state(corners, u, ELASTIC, is_nlgeom).forces[0]
    step = 1e-5
    for a in range(8):
        for i in range(3):
            plus, minus = u.copy(), u.copy()
            plus[0, a, i] += step
            minus[0, a, i] -= step
            energies = [element.element_state(corners, v, ELASTIC, is_nlgeom).energy[0] for v in (plus, minus)]
            assert forces[a, i] == pytest.approx((energies[0] - energies[1]) / (2 * step), abs=1e-7 * abs(forces).max())


def test_uniaxial_stretch_of_a_cube() -> None:
    """Hencky: tau_zz = E ln(stretch) with lateral stretch**(-nu); the force is tau times A0 over the stretch."""
    stretch = 1.3
    side = stretch**-0.3
    corners = (element.CORNERS[None] + 1.0) / 2
    u = corners * (np.array([side, side, stretch]) - 1)
    state = element.element_state(corners, u, ELASTIC, True)
    assert state.forces[0, 4:, 2].sum() == pytest.approx(1000 * np.log(stretch) / stretch, rel=1e-12)
    assert abs(state.forces[0, :, :2]).max() < 1e-10


def test_rigid_rotation_gives_no_force() -> None:
    """A rotation by 70 degrees about a general axis."""
    axis = np.array([1.0, 2.0, -1.0]) / np.sqrt(6)
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    angle = np.radians(70)
    turn = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    corners = distorted(4, 0.1)
    state = element.element_state(corners, corners @ turn.T - corners, ELASTIC, True)
    assert abs(state.forces).max() < 1e-11 * 1000


def test_projection_on_warped_facets() -> None:
    """Points put at a known distance along the facet's own normal are found again."""
    corners = np.array([[[0.0, 0, 0], [1, 0, 0.1], [1.1, 1, -0.1], [0, 0.9, 0.2]]]).repeat(9, axis=0)
    xi = np.array([[a, b] for a in (-0.9, 0.0, 0.8) for b in (-0.7, 0.1, 0.95)])
    points = facets.facet_point(corners, xi) + 0.05 * facets.unit(facets.facet_normal(corners, xi))
    found, edge = facets.closest_on_facets(points, corners)
    assert np.allclose(found, xi, atol=1e-10)
    assert (edge == -1).all()


def test_projection_beyond_an_edge_and_a_corner() -> None:
    """Clamped to the edge, to the corner."""
    corners = np.array([[[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]]).repeat(2, axis=0)
    found, edge = facets.closest_on_facets(np.array([[1.5, 0.25, 0.3], [-1.0, -2.0, 0.0]]), corners)
    assert np.allclose(found, [[1, -0.5], [-1, -1]])
    assert edge[0] == 1 and edge[1] in (0, 3)


def two_blocks(mu: float = 1.5, press: float = 1e-3, gap: float = 0.0) -> tuple[str, Results]:
    """Two blocks with matching meshes, pressed and sheared at the top, glued in the interface: the right answer of a
    contact problem while friction sticks. Then the upper body is moved by gap in z.
    """
    line = np.linspace(0, 1, 5)
    parts = [make_decks.block(line, line, line + low, name) for low, name in ((0.0, "LOWER"), (1.0, "UPPER"))]
    mesh = make_decks.join(parts)
    mesh.element_sets["ALL"] = np.arange(len(mesh.elements))
    deck = (
        make_decks.mesh_cards(mesh)
        + make_decks.material_cards("SOFT", (1e4, 0.25), "ALL")
        + make_decks.contact_cards("UPPER_BOTTOM", "LOWER_TOP", mu)
        + "*STEP\n*STATIC\n1., 1.\n*BOUNDARY\nLOWER_BOTTOM, 1, 3\nUPPER_TOP, 1, 3\n*END STEP\n"
    )
    u = glued_solution(mesh, np.array([0.1 * press, 0.0, -press]))
    u[np.arange(len(u)) >= len(parts[0].nodes), 2] += gap
    return deck, Results(mesh.nodes, np.array([0.0, 1.0]), np.stack([0 * u, u]), None, deck)


def glued_solution(mesh: make_decks.Mesh, top: np.ndarray) -> np.ndarray:
    """Small displacements: lower bottom fixed, upper top moved, interface nodes in pairs; dense algebra."""
    n = len(mesh.nodes)
    corners = mesh.nodes[mesh.elements[:1]]
    units = np.eye(24).reshape(24, 8, 3)
    columns = [
        element.element_state(corners, unit[None], np.array([[1e4, 0.25]]), False).forces.ravel() for unit in units
    ]
    stiffness = np.zeros((3 * n, 3 * n))
    for nodes in mesh.elements:
        dofs = (3 * nodes[:, None] + np.arange(3)).ravel()
        stiffness[np.ix_(dofs, dofs)] += np.array(columns)
    glue = np.arange(n)
    glue[mesh.node_sets["UPPER_BOTTOM"]] = mesh.node_sets["LOWER_TOP"]
    reduce = np.zeros((3 * n, 3 * n))
    reduce[np.arange(3 * n), (3 * glue[:, None] + np.arange(3)).ravel()] = 1.0
    u = np.zeros((n, 3))
    u[mesh.node_sets["UPPER_TOP"]] = top
    held = np.concatenate([mesh.node_sets["UPPER_TOP"], mesh.node_sets["LOWER_BOTTOM"], mesh.node_sets["UPPER_BOTTOM"]])
    free = (3 * np.setdiff1d(np.arange(n), held)[:, None] + np.arange(3)).ravel()
    matrix = reduce.T @ stiffness @ reduce
    full = u.ravel()
    full[free] = np.linalg.solve(matrix[np.ix_(free, free)], -(matrix @ full)[free])
    return (reduce @ full).reshape(n, 3)


def verdict(mu: float = 1.5, press: float = 1e-3, gap: float = 0.0) -> IncrementCheck:
    """The check of the two blocks."""
    deck, results = two_blocks(mu, press, gap)
    return next(iter(ContactCheck(read_deck(deck), results).run()))


def test_a_right_state_passes() -> None:
    """Everything sticks; the normal force is between that of a bar and that of a constrained one."""
    check = verdict()
    pair = check.pairs[0]
    assert check.failures == []
    assert (pair.n_open, pair.n_stick, pair.n_slip) == (0, 25, 0)
    assert 1e4 * 1e-3 / 2 < pair.normal_force < 1.2 * 1e4 * 1e-3 / 2
    assert 0 < pair.shear_force < 0.1 * pair.normal_force
    assert pair.largest_pressure > pair.normal_force


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ({"mu": 0.02}, "friction"),
        ({"press": -1e-3}, "tension"),
        ({"gap": -1e-6}, "penetration"),
        ({"gap": 1e-6}, "open_force"),
    ],
)
def test_a_wrong_state_fails(arguments: dict[str, float], name: str) -> None:
    """Each law that is broken is named."""
    check = verdict(**arguments)
    assert any(failure.startswith(name) for failure in check.failures), check.failures


def test_an_unbalanced_state_fails() -> None:
    """One node moved: its forces and its neighbours' no longer balance."""
    deck, results = two_blocks()
    results.displacements[1, read_deck(deck).elements[5, 6], 0] += 1e-6
    check = next(iter(ContactCheck(read_deck(deck), results).run()))
    assert any(failure.startswith("equilibrium") for failure in check.failures)


def test_slip_is_counted_and_judged() -> None:
    """The upper block moved as a whole: all slip, though friction is below its limit, and half of it acts along the slip."""
    deck, results = two_blocks()
    upper = np.arange(len(results.points)) >= len(results.points) // 2
    results.displacements[1, upper, 0] += 1e-3
    check = next(iter(ContactCheck(read_deck(deck), results).run()))
    assert check.pairs[0].n_slip == 25
    assert any(failure.startswith("unused") for failure in check.failures)
    assert any(failure.startswith("direction") for failure in check.failures)


def test_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """From a file of the documented layout to exit codes 0 and 1, and 2 without a file."""
    for mu, expected in ((1.5, 0), (0.02, 1)):
        deck, results = two_blocks(mu)
        path = tmp_path / f"job_{expected}.vtkhdf"
        write_file(path, deck, results)
        assert contact_check.main([str(path), "--json", str(tmp_path / "report.json")]) == expected
    assert "FAIL" in capsys.readouterr().out
    assert (tmp_path / "report.json").stat().st_size > 100
    assert contact_check.main([str(tmp_path / "absent.vtkhdf")]) == 2


def write_file(path: Path, deck: str, results: Results) -> None:
    """A result file with the parts that the check reads."""
    n_frames, n = results.displacements.shape[:2]
    with h5py.File(path, "w") as file:
        grid = file.create_group("VTKHDF")
        grid["NumberOfPoints"] = [n]
        grid["Points"] = results.points
        grid["PointData/U"] = results.displacements.reshape(-1, 3)
        grid["Steps/Values"] = results.times
        grid["Steps/PointDataOffsets/U"] = np.arange(n_frames) * n
        file["AMONTONS/deck"] = deck


def test_unknown_cards_are_refused() -> None:
    """A check of half a model would be worse than none."""
    with pytest.raises(DeckError, match="PLASTIC"):
        read_deck("*NODE\n1, 0, 0, 0\n*MATERIAL, NAME=M\n*PLASTIC\n1., 0.\n")


def test_decks_of_input_are_read() -> None:
    """Counts of bodies, slaves and facets of the decks of input/."""
    expected = {"three_cubes": (4, 2), "shear_block": (144, 225), "ironing": (26, 60)}
    for name, counts in expected.items():
        path = VERIFY.parent / "input" / f"{name}.inp"
        deck = read_deck(path.read_text(), path.parent)
        pair = deck.pairs[0]
        assert (len(deck.surface_nodes(pair.slave)), len(deck.facets(pair.master))) == counts, name
        assert deck.bodies().max() == 1
        assert len(deck.steps) == 2 and deck.steps[1].is_nlgeom
        assert deck.step_at(1.0) == 0 and deck.step_at(1.1) == 1 and deck.step_at(2.0) == 1
