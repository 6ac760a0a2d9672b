"""Conventions of CalculiX that the calculix dialect takes over: output and counting rules. Each has a closed form.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import h5py
import pytest

from verify.decks import feature_decks
from verify.decks.mixed_decks import deck, hold, prints, solid, step
from verify.decks.solids import unit_cube
from verify.readers.dat_frd_files import Block, read_dat, read_frd

CUBE = unit_cube("N") + """*BOUNDARY
1, 1, 3
4, 1
5, 1, 2
8, 1
2, 2, 3
6, 2
3, 3
4, 3
"""
LINEAR = "*MATERIAL, NAME=M\n*ELASTIC\n1000., .25\n*SOLID SECTION, ELSET=E, MATERIAL=M\n"


@pytest.fixture
def tables(run_deck: Callable[..., object], tmp_path: Path) -> Callable[..., list[Block]]:
    """Runs a deck and reads its tables."""

    def read(text: str, dialect: str = "calculix") -> list[Block]:
        result = run_deck(text, f"--dialect={dialect}")
        assert result.returncode == 0, result.stdout + result.stderr  # type: ignore[attr-defined]
        return read_dat(tmp_path / "job.dat")

    return read


def times(blocks: list[Block]) -> list[float]:
    """The times of the blocks."""
    return [round(block.time, 6) for block in blocks]


def test_linear_steps_are_whole(tables: Callable[..., list[Block]]) -> None:
    """A linear step is one increment whatever it requests, an NLGEOM step is not, and the abaqus dialect keeps increments."""
    points = "*TIME POINTS, NAME=T\n.3\n"
    load = "*CLOAD\n7, 1, 2.\n*NODE PRINT, NSET=N, TIME POINTS=T\nU\n"
    linear = CUBE + points + LINEAR + f"*STEP\n*STATIC\n.25, 1.\n{load}*END STEP\n"
    assert times(tables(linear)) == [1.0]
    assert times(tables(linear, "abaqus")) == [0.3, 1.0]
    assert times(tables(linear.replace("*STEP\n", "*STEP, NLGEOM\n"))) == [0.3, 1.0]


def test_clock(tables: Callable[..., list[Block]]) -> None:
    """TOTAL TIME AT START sets the clock; TIME RESET turns it back by the length of the step; both continue from there."""
    out = "*NODE PRINT, NSET=N\nU\n*END STEP\n"
    text = CUBE + LINEAR
    for option, length in ((", TOTAL TIME AT START=2.5", 2), ("", 1), (", TIME RESET", 3), ("", 4)):
        text += f"*STEP\n*STATIC{option}\n{length}, {length}\n" + out
    assert times(tables(text)) == [4.5, 5.5, 5.5, 9.5]


def test_amplitude_follows_the_clock(tables: Callable[..., list[Block]]) -> None:
    """An amplitude in total time is read at the time that TOTAL TIME AT START sets."""
    text = CUBE + LINEAR + "*AMPLITUDE, NAME=A, TIME=TOTAL TIME\n0., 0., 10., 1.\n"
    text += "*STEP\n*STATIC, TOTAL TIME AT START=4.\n1., 1.\n*CLOAD, AMPLITUDE=A\n" + "".join(f"{n}, 1, 25.\n" for n in (2, 3, 6, 7))
    blocks = tables(text + "*EL PRINT, ELSET=E\nS\n*END STEP\n")
    assert list(blocks[0].rows.values())[0][0] == pytest.approx(50.0, rel=1e-6)  # half of 4 x 25 over an area of 1


def test_all_output_shares_its_times(tables: Callable[..., list[Block]], tmp_path: Path) -> None:
    """The last FREQUENCY of all PRINT and FILE cards counts for both files; under abaqus each has its own."""
    step = "*STEP, NLGEOM\n*STATIC, DIRECT\n.1, 1.\n*CLOAD\n7, 1, 2.\n*NODE PRINT, NSET=N, FREQUENCY=3\nU\n*NODE FILE, FREQUENCY=4\nU\n*END STEP\n"
    assert times(tables(CUBE + LINEAR + step)) == [0.4, 0.8, 1.0]
    assert times(read_frd(tmp_path / "job.frd")) == [0.4, 0.8, 1.0]
    assert times(tables(CUBE + LINEAR + step, "abaqus")) == [0.3, 0.6, 0.9, 1.0]


def test_amplitudes_are_factors(tables: Callable[..., list[Block]]) -> None:
    """VALUE=ABSOLUTE is no word of CalculiX: 100 on a face of 1 times 0.5 there, 0.5 alone under abaqus."""
    text = CUBE + LINEAR + "*AMPLITUDE, NAME=A, VALUE=ABSOLUTE\n0., 0., 1., .5\n*STEP\n*STATIC\n*CLOAD, AMPLITUDE=A\n"
    text += "".join(f"{n}, 1, 25.\n" for n in (2, 3, 6, 7)) + "*EL PRINT, ELSET=E\nS\n*END STEP\n"
    for dialect, stress in (("calculix", 50.0), ("abaqus", 2.0)):
        assert list(tables(text, dialect)[0].rows.values())[0][0] == pytest.approx(stress, rel=1e-6)


def test_controls_of_the_model(tables: Callable[..., list[Block]]) -> None:
    """CONTROLS may stand before the first step; it does not change a linear one."""
    load = "*STEP\n*STATIC\n*CLOAD\n7, 1, 2.\n*NODE PRINT, NSET=N\nU\n*END STEP\n"
    plain = tables(CUBE + LINEAR + load)[0].rows
    extra = "*CONTROLS, PARAMETERS=FIELD\n.001, .01\n"
    assert tables(CUBE + LINEAR + extra + load)[0].rows == plain


@pytest.mark.parametrize("plastic", ["", "*PLASTIC\n1.E6, 0.\n"])
def test_free_expansion(tables: Callable[..., list[Block]], plastic: str) -> None:
    """Under NLGEOM a thermal strain is a stretch: a free edge of 1 grows by alpha dT, the mechanical strain is zero."""
    material = LINEAR.replace("*SOLID", f"{plastic}*EXPANSION\n1.E-4\n*SOLID")
    blocks = tables(CUBE + material + "*STEP, NLGEOM\n*STATIC\n*TEMPERATURE\nN, 1000.\n*NODE PRINT, NSET=N\nU\n"
                    "*EL PRINT, ELSET=E\nE, ME\n*END STEP\n")
    u, strain, mechanical = blocks
    assert u.rows[(7,)] == pytest.approx([0.1, 0.1, 0.1], rel=1e-6)
    assert strain.rows[(1, 1)][:3] == pytest.approx([0.105] * 3, rel=1e-6)
    assert mechanical.title == "mechanical strains"
    assert max(abs(v) for row in mechanical.rows.values() for v in row) < 1e-7


def test_mechanical_strain(tables: Callable[..., list[Block]]) -> None:
    """ME is E less alpha dT at small displacements, and E itself where nothing is warm."""
    material = LINEAR.replace("*SOLID", "*EXPANSION\n1.E-4\n*SOLID")
    cold = "*STEP\n*STATIC\n*BOUNDARY\n7, 1, 1, .01\n*EL PRINT, ELSET=E\nE, ME\n*END STEP\n"
    warm = "*STEP\n*STATIC\n*TEMPERATURE\nN, 10.\n*EL PRINT, ELSET=E\nE, ME\n*END STEP\n"
    blocks = tables(CUBE + material + cold + warm)
    for total, mechanical, thermal in ((blocks[0], blocks[1], 0.0), (blocks[2], blocks[3], 1e-3)):
        for key, row in total.rows.items():
            expected = [v - thermal * (i < 3) for i, v in enumerate(row)]
            assert mechanical.rows[key] == pytest.approx(expected, abs=1e-8)


def test_sector(tables: Callable[..., list[Block]]) -> None:
    """Volume, energy and forces of a ring in uniform biaxial strain are those of two degrees of it, as CalculiX expands it.

    With u_r = c r and u_y = 0 radial and hoop stress are s = 2 (lambda + G) c. The shares of the two outer nodes of the
    force of the radial stress alone are s h (a + b)/2 times the angle, the hoop stress takes no part.
    """
    a, b, h, c = 1.0, 1.5, 0.4, 1e-3
    lame, G = 400.0, 400.0
    s = 2 * (lame + G) * c
    text = f"""*NODE, NSET=N
1, {a}, 0.
2, {b}, 0.
3, {b}, {h}
4, {a}, {h}
*NSET, NSET=OUT
2, 3
*ELEMENT, TYPE=CAX4, ELSET=E
1, 1, 2, 3, 4
{LINEAR}*BOUNDARY
N, 2
1, 1, 1, {c * a}
4, 1, 1, {c * a}
OUT, 1, 1, {c * b}
*STEP
*STATIC
*NODE PRINT, NSET=OUT, TOTALS=ONLY
RF
*EL PRINT, ELSET=E
EVOL, ELSE
*END STEP
"""
    force, volume, energy = (list(block.rows.values())[0] for block in tables(text))
    angle = math.radians(2)
    assert force[0] == pytest.approx(s * h * (a + b) / 2 * angle, rel=1e-6)
    assert volume[0] == pytest.approx((b**2 - a**2) / 2 * angle * h, rel=1e-6)
    assert energy[0] == pytest.approx(s * c * (b**2 - a**2) / 2 * angle * h, rel=1e-6)


def test_totals_are_global(tables: Callable[..., list[Block]]) -> None:
    """The total of forces at nodes with directions of their own is summed in global directions: it balances the load."""
    body = solid("C3D8")
    turned = hold(body) + "*TRANSFORM, NSET=LEFT, TYPE=R\n.6, .8, 0., -.8, .6, 0.\n"
    text = deck(body, "*ELASTIC\n1000., .3\n", turned, step("*CLOAD\nTIP, 1, 5.\n" + prints(element_items="")))
    text = text.replace("*NODE PRINT, NSET=NODES", "*NODE PRINT, NSET=LEFT")
    total = next(block for block in tables(text) if block.title == "total force")
    assert list(total.rows.values())[0] == pytest.approx([-5.0, 0.0, 0.0], abs=1e-5)


@pytest.mark.parametrize("nlgeom", ["", ", NLGEOM"])
def test_hourglass_stiffness(tables: Callable[..., list[Block]], nlgeom: str) -> None:
    """C3D8R: the forces of an hourglass mode of size d on a unit cube are k 8 d with k = 0.0005 E V sum |grad N_a|^2 = 0.00075 E."""
    d = 1e-3
    signs = {1: 1, 2: -1, 3: 1, 4: -1, 5: 1, 6: -1, 7: 1, 8: -1}  # xi eta
    text = CUBE[: CUBE.index("*BOUNDARY")].replace("C3D8", "C3D8R") + LINEAR + "*BOUNDARY\nN, 2, 3\n"
    text += f"*STEP{nlgeom}\n*STATIC\n*BOUNDARY\n" + "".join(f"{n}, 1, 1, {d * s}\n" for n, s in signs.items())
    (force,) = tables(text + "*NODE PRINT, NSET=N\nRF\n*END STEP\n")
    for node, sign in signs.items():
        assert force.rows[(node,)][0] == pytest.approx(sign * 0.00075 * 1000 * 8 * d, rel=1e-6)


def rubber_modulus(stretch: float, c10: float = 200.0, d1: float = 2e-3) -> float:
    """dS11/dE11 of neo-Hooke rubber stretched along x alone: 4 d2W/dC11^2."""

    def energy(c: float) -> float:
        return c10 * ((c + 2) * c ** (-1 / 3) - 3) + (math.sqrt(c) - 1) ** 2 / d1

    c, h = stretch**2, 1e-4
    return 4 * (energy(c + h) - 2 * energy(c) + energy(c - h)) / h**2


ALONG = "*SOLID SECTION, ELSET=E, MATERIAL=M\n"
AXES = "*ORIENTATION, NAME=O\n0., 1., 0., -1., 0., 0.\n*SOLID SECTION, ELSET=E, MATERIAL=M, ORIENTATION=O\n"
PLASTIC = "*ELASTIC\n1000., .25\n*PLASTIC\n1., 0.\n2., 1.\n"
CREEP = "*ELASTIC\n1000., .25\n*CREEP, LAW=NORTON\n1.E-9, 2., 0.\n"
STIFF = "*ELASTIC, TYPE=ORTHO\n1500., 300., 1200., 200., 250., 900., 400., 350.\n300.\n"
RUBBER = "*HYPERELASTIC, NEO HOOKE\n200., .002\n"


@pytest.mark.parametrize(("law", "section", "stretch", "modulus"), [
    (PLASTIC, ALONG, 0.0, 1200.0), (CREEP, ALONG, 0.0, 1200.0),
    (STIFF, ALONG, 0.0, 1500.0), (STIFF, AXES, 0.0, 1200.0),
    (RUBBER, ALONG, 0.0, rubber_modulus(1.0)), (RUBBER, ALONG, 0.2, rubber_modulus(1.2)),
    (RUBBER, ALONG, -0.2, rubber_modulus(0.8))], ids=["plastic", "creep", "orthotropic", "turned", "rubber", "pulled", "pressed"])
def test_modulus_of_hourglass_stiffness(tables: Callable[..., list[Block]], law: str, section: str, stretch: float, modulus: float) -> None:
    """The same with dS11/dE11 in place of E for all materials that have more than E and nu; C1111 = 1.2 E at rest for nu = 1/4."""
    d = 0.1
    signs = {1: 1, 2: -1, 3: 1, 4: -1, 5: 1, 6: -1, 7: 1, 8: -1}
    text = CUBE[: CUBE.index("*BOUNDARY")].replace("C3D8", "C3D8R") + "*MATERIAL, NAME=M\n" + law + section + "*BOUNDARY\nN, 2, 3\n"
    at = {int(n): stretch * float(x) for n, x, _, _ in (line.split(",") for line in CUBE.splitlines()[1:9])}
    text += "*STEP, NLGEOM\n*STATIC\n*BOUNDARY\n" + "".join(f"{n}, 1, 1, {at[n] + d * s}\n" for n, s in signs.items())
    force = tables(text + "*NODE PRINT, NSET=N\nRF\n*END STEP\n")[-1]
    mode = sum(sign * force.rows[(node,)][0] for node, sign in signs.items()) / 8
    assert mode == pytest.approx(0.00075 * modulus * 8 * d, rel=1e-4)


@pytest.mark.parametrize("kind", ["CPE4", "CAX4"])
def test_area_of_a_slave_node_in_the_plane(tables: Callable[..., list[Block]], kind: str) -> None:
    """A slave of a surface of nodes stands for the length L of its facet, times the thickness or 2 pi times its own radius.

    A stiff block of width w is pressed by p on one such node; CalculiX's exponential law is p_n = p0 exp(d ln(100)/c0) at overclosure d.
    """
    length, w, x, t, load, p0, c0 = 2.0, 0.6, 2.2, 10.0, 0.25, 0.1, 1e-2
    text = f"""*NODE, NSET=N
1, 2., 0.
2, {2 + length}, 0.
3, {2 + length}, 1.
4, 2., 1.
11, {x}, 1.
12, {x + w}, 1.
13, {x + w}, 2.
14, {x}, 2.
*ELEMENT, TYPE={kind}, ELSET=E
1, 1, 2, 3, 4
2, 11, 12, 13, 14
*MATERIAL, NAME=M
*ELASTIC
1.E6, 0.
*SOLID SECTION, ELSET=E, MATERIAL=M
{t if kind == "CPE4" else ","}
*BOUNDARY
1, 1, 2
2, 1, 2
3, 1, 2
4, 1, 2
11, 1
12, 1
13, 1
14, 1
*SURFACE, NAME=MASTER
1, S3
*SURFACE, NAME=SLAVE, TYPE=NODE
11
*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=EXPONENTIAL
{c0}, {p0}
*CONTACT PAIR, INTERACTION=I, TYPE=NODE TO SURFACE
SLAVE, MASTER
*STEP
*STATIC
*DLOAD
2, P3, {load}
*NODE PRINT, NSET=N
U
*END STEP
"""
    is_plane = kind == "CPE4"
    force = load * (w * t if is_plane else math.pi * ((x + w) ** 2 - x**2))
    area = length * (t if is_plane else 2 * math.pi * x)
    overclosure = c0 / math.log(100) * math.log(force / area / p0)
    (u,) = tables(text)[-1:]
    assert -u.rows[(11,)][1] == pytest.approx(overclosure, rel=1e-3)


def test_plane_beside_axisymmetric(tables: Callable[..., list[Block]]) -> None:
    """Where a model has axisymmetric elements, forces and volumes of plane ones are those of a 180th of their thickness too."""
    ring = "*NODE\n11, 5., 0.\n12, 6., 0.\n13, 6., 1.\n14, 5., 1.\n*ELEMENT, TYPE=CAX4, ELSET=A\n2, 11, 12, 13, 14\n"
    ring += "*SOLID SECTION, ELSET=A, MATERIAL=M\n,\n*BOUNDARY\n11, 2\n12, 2\n"
    text = "*NODE, NSET=N\n1, 2., 0.\n2, 3., 0.\n3, 3., 1.\n4, 2., 1.\n*ELEMENT, TYPE=CPS4, ELSET=P\n1, 1, 2, 3, 4\n"
    text += "*MATERIAL, NAME=M\n*ELASTIC\n1000., .3\n*SOLID SECTION, ELSET=P, MATERIAL=M\n18.\n*BOUNDARY\n1, 1, 2\n4, 1\n"
    end = "*STEP\n*STATIC\n*CLOAD\n2, 1, 9.\n3, 1, 9.\n*NODE PRINT, NSET=N\nRF\n*EL PRINT, ELSET=P\nS, EVOL\n*END STEP\n"
    for more, share in (("", 1), (ring, 180)):
        force, stress, volume = tables(text + more + end)
        assert force.rows[(2,)][0] == pytest.approx(9 / share, rel=1e-6)
        assert stress.rows[(1, 1)][0] == pytest.approx(1.0, rel=1e-6)
        assert volume.rows[(1,)][0] == pytest.approx(18 / share, rel=1e-6)


def test_mean_normal_of_a_section(tables: Callable[..., list[Block]]) -> None:
    """The mean normal of two equal faces at right angles is half of each: it is a mean over the area, not a direction."""
    text = CUBE + "*SURFACE, NAME=BOTH\nE, S2\nE, S4\n" + LINEAR
    blocks = tables(text + "*STEP\n*STATIC\n*BOUNDARY\n7, 1, 1, .01\n*SECTION PRINT, SURFACE=BOTH, NAME=B\nSOF, SOM\n*END STEP\n")
    row = list(next(block for block in blocks if block.title.startswith("center")).rows.values())[0]
    assert row == pytest.approx([0.75, 0.5, 0.75, 0.5, 0.0, 0.5], abs=1e-6)


@pytest.mark.parametrize("kind", [feature_decks.NODES, feature_decks.FACES_TYPE])
def test_energy_of_springs_at_nodes(run_deck: Callable[..., object], tmp_path: Path, kind: str) -> None:
    """CELS of a .frd file adds up to the total of CONTACT PRINT: exactly at slave nodes; where points give to nodes but for the shear,
    of which they give means (a tenth of the energy here, whose square differs by less than a half from its mean's)."""
    law = feature_decks.LINEAR + feature_decks.RUB
    text = feature_decks.contact_deck("C3D8", kind, law, [feature_decks.push(x=0.001)]).replace("*END STEP", "*CONTACT FILE\nCELS\n*END STEP")
    result = run_deck(text, "--dialect=calculix")
    assert result.returncode == 0, result.stdout + result.stderr  # type: ignore[attr-defined]
    (total,) = [block for block in read_dat(tmp_path / "job.dat") if block.title.startswith("total contact spring")]
    (field,) = [block for block in read_frd(tmp_path / "job.frd") if block.title == "CELS"]
    tolerance = 2e-5 if kind == feature_decks.NODES else 5e-2
    assert sum(row[0] for row in field.rows.values()) == pytest.approx(next(iter(total.rows.values()))[0], rel=tolerance)


TWO = [0.2, 0.4, 0.6, 0.8, 1.0]
THREE = [0.3, 0.6, 0.9, 1.0]
POINTS = [0.3, 0.7, 1.0]
EACH = [round(0.1 * i, 6) for i in range(1, 11)]


@pytest.mark.parametrize(("prints", "files", "is_print_first", "printed", "written"), [
    (", FREQUENCY=2", ", FREQUENCY=3", True, THREE, THREE), (", FREQUENCY=2", ", FREQUENCY=3", False, TWO, TWO),
    (", FREQUENCY=2", "", True, TWO, TWO), ("", ", FREQUENCY=3", True, THREE, THREE), ("", ", TIME POINTS=T", False, POINTS, POINTS),
    (", FREQUENCY=2", ", TIME POINTS=T", False, TWO, TWO), (", FREQUENCY=0", "", True, [], EACH), ("", ", FREQUENCY=0", True, EACH, []),
])  # fmt: skip
def test_one_frequency(run_deck: Callable[..., object], tmp_path: Path, prints: str, files: str, is_print_first: bool,  # noqa: PLR0913, FBT001
                       printed: list[float], written: list[float]) -> None:  # fmt: skip
    """The last FREQUENCY or TIME POINTS of PRINT and FILE cards holds for all of them, and for later steps; 0 for its kind alone."""
    cards = [f"*NODE PRINT, NSET=N{prints}\nU\n", f"*NODE FILE{files}\nU\n"]
    static = "*STATIC\n.1, 1., 1e-5, .1\n*CLOAD\n7, 1, 2.\n"
    deck = CUBE + "*TIME POINTS, NAME=T\n.3, .7\n" + LINEAR + f"*STEP, NLGEOM\n{static}{''.join(cards if is_print_first else cards[::-1])}*END STEP\n"
    result = run_deck(deck + f"*STEP\n{static}*END STEP\n", "--dialect=calculix")
    assert result.returncode == 0, result.stdout + result.stderr  # type: ignore[attr-defined]
    later = [round(1 + time, 6) for time in printed]
    assert times(read_dat(tmp_path / "job.dat")) == printed + later
    assert times(read_frd(tmp_path / "job.frd")) == written + [round(1 + time, 6) for time in written]


def test_energy_after_flow(tables: Callable[..., list[Block]], tmp_path: Path) -> None:
    """Simo's plasticity: a bar that is drawn far beyond yield stores the elastic energy s s/(2 E), to the order of s/E; ENER shows all
    work, s ln(1.2) and little more (the length after it has yielded is 1.002, and the trapezoidal rule errs by a half of the first
    increment)."""
    material = LINEAR.replace("*SOLID", "*PLASTIC\n2., 0.\n*SOLID")
    pull = "".join(f"{n}, 1, 1, .2\n" for n in (2, 3, 6, 7))
    steps = f"*STEP, NLGEOM\n*STATIC\n.02, 1., , .02\n*BOUNDARY\n{pull}*EL PRINT, ELSET=E\nS, ENER\n*END STEP\n"
    blocks = tables(CUBE + material + steps)
    stress, energy = (list(block.rows.values())[0][0] for block in blocks[-2:])
    assert stress == pytest.approx(2.0, rel=5e-3)
    assert energy == pytest.approx(2.0 * math.log(1.2), rel=1e-2)
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        stored = file["AMONTONS/history/strain_energy"][-1]
    assert float(stored) == pytest.approx(2.0**2 / 2 / 1000, rel=1e-2)


REF = "*NODE, NSET=REF\n101, 1.5, .5, .5\n*RIGID BODY, NSET=END, REF NODE=101\n*NSET, NSET=END\n2, 3, 6, 7\n"
WALL = CUBE.split("*BOUNDARY")[0] + "*NSET, NSET=BACK\n1, 4, 5, 8\n*BOUNDARY\nBACK, 1, 3\n"


def test_forces_at_reference_node(tables: Callable[..., list[Block]]) -> None:
    """RF of a reference node without elements is all that acts there: the load, or the reaction of a support that takes its place."""
    out = "*NODE PRINT, NSET=REF\nU, RF\n*NODE PRINT, NSET=BACK, TOTALS=ONLY\nRF\n*END STEP\n"
    loaded = tables(WALL + REF + LINEAR + f"*STEP\n*STATIC\n*CLOAD\n101, 1, 7.\n{out}")
    moved = loaded[0].rows[(101,)]
    assert loaded[1].rows[(101,)] == pytest.approx([7.0, 0.0, 0.0], abs=1e-6)
    assert loaded[2].rows[(1,)] == pytest.approx([-7.0, 0.0, 0.0], abs=1e-6)
    held = tables(WALL + REF + LINEAR + f"*STEP\n*STATIC\n*BOUNDARY\n101, 1, 1, {moved[0]:.9g}\n{out}")
    assert held[1].rows[(101,)] == pytest.approx([7.0, 0.0, 0.0], abs=1e-4)


def test_springs_do_not_thin_out_stress(run_deck: Callable[..., object], tmp_path: Path) -> None:
    """A spring at a node has no stress and does not count in the mean of the elements there."""
    spring = "*ELEMENT, TYPE=SPRING1, ELSET=SP\n9, 7\n*SPRING, ELSET=SP\n2\n1.E-9\n"
    load = "*STEP\n*STATIC\n*CLOAD\n" + "".join(f"{n}, 1, 2.5\n" for n in (2, 3, 6, 7)) + "*EL FILE\nS\n*END STEP\n"
    result = run_deck(CUBE + LINEAR + spring + load, "--dialect=calculix")
    assert result.returncode == 0, result.stdout + result.stderr  # type: ignore[attr-defined]
    stress = next(block for block in read_frd(tmp_path / "job.frd") if block.title == "STRESS")
    for row in stress.rows.values():
        assert row == pytest.approx([10.0, 0, 0, 0, 0, 0], abs=1e-6)


@pytest.mark.parametrize("kind", ["T3D2", "T3D3"])
def test_truss_tables(tables: Callable[..., list[Block]], kind: str) -> None:
    """A truss at 60 degrees prints its tensors in global axes, at the points of the bar that CalculiX makes of it; the middle node of
    T3D3 stays on the line, also under NLGEOM.
    """
    c, s = 0.5, math.sqrt(0.75)
    rows, ends = (8, "1, 2") if kind == "T3D2" else (27, "1, 3, 2")
    text = f"*NODE, NSET=N\n1, 0, 0, 0\n2, {2 * c}, {2 * s:.12g}, 0\n" + (f"3, {c}, {s:.12g}, 0\n" if kind == "T3D3" else "")
    text += f"*ELEMENT, TYPE={kind}, ELSET=E\n1, {ends}\n" + LINEAR + "0.1\n*BOUNDARY\n1, 1, 3\n2, 3\n*TRANSFORM, NSET=TIP, TYPE=R\n"
    text += f"{c}, {s:.12g}, 0., {-s:.12g}, {c}, 0.\n*NSET, NSET=TIP\n2\n*BOUNDARY\n2, 2\n"
    for option in ("", ", NLGEOM"):
        blocks = tables(text + f"*STEP{option}\n*STATIC\n*CLOAD\n2, 1, .1\n*NODE PRINT, NSET=N\nU\n*EL PRINT, ELSET=E\nS, E\n*END STEP\n")
        u, stress, strain = blocks
        assert len(stress.rows) == rows
        for row in stress.rows.values():  # 0.1 over 0.1; NLGEOM: over the area now
            assert row == pytest.approx([c * c, s * s, 0, c * s, 0, 0], rel=2e-3, abs=1e-9)
        for row in strain.rows.values():
            e, t = 1e-3, -0.25e-3
            expected = [t + (e - t) * c * c, t + (e - t) * s * s, t, (e - t) * c * s, 0, 0]
            assert row == pytest.approx(expected, rel=2e-3, abs=1e-9)
        if kind == "T3D3":
            assert u.rows[(2,)] == pytest.approx([2e-3, 0, 0], rel=2e-3, abs=1e-12)  # along the line
            assert u.rows[(3,)] == pytest.approx([1e-3 * c, 1e-3 * s, 0], rel=2e-3, abs=1e-12)


def test_stiff_gap_leaves_no_force(tables: Callable[..., list[Block]]) -> None:
    """A gap as stiff as 1e12 closes: what the first iterate makes of it is no measure for what may be left unbalanced."""
    text = WALL + "*NODE, NSET=STOP\n101, 1.5, 1., 1.\n102, 1.5, 0., 0.\n*BOUNDARY\nSTOP, 1, 3\n"
    text += "*ELEMENT, TYPE=GAPUNI, ELSET=G\n9, 7, 101\n10, 2, 102\n*GAP, ELSET=G\n.01, 1., 0., 0.\n" + LINEAR
    text += "*STEP, NLGEOM\n*STATIC\n*CLOAD\n7, 1, 30.\n2, 1, -4.\n2, 2, 5.\n*NODE PRINT, NSET=N\nU, RF\n*NODE PRINT, NSET=STOP\nRF\n*END STEP\n"
    u, forces, stops = tables(text)
    assert u.rows[(7,)][0] == pytest.approx(0.01, rel=1e-6)
    assert forces.rows[(7,)] == pytest.approx([30.0, 0, 0], abs=0.03)
    assert forces.rows[(2,)] == pytest.approx([-4.0, 5.0, 0], abs=0.03)
    assert -30 < stops.rows[(101,)][0] < -15 and abs(stops.rows[(102,)][0]) < 0.01


def test_constraints_that_are_not_linear(tables: Callable[..., list[Block]]) -> None:
    """MPC PLANE and STRAIGHT turn NLGEOM on, as CalculiX 2.20 says when it reads them; MEANROT and the abaqus dialect do not."""
    body = CUBE[: CUBE.index("*BOUNDARY")] + LINEAR + "*BOUNDARY\n1, 1, 3\n2, 1, 3\n3, 1, 3\n4, 1, 3\n"
    load = "*STEP{}\n*STATIC\n*CLOAD\n7, 1, 30.\n6, 3, -20.\n*NODE PRINT, NSET=N\nU\n*END STEP\n"
    for mpc, is_turned_on in (("PLANE, 5, 6, 7, 8", True), ("STRAIGHT, 5, 6, 2", True), ("MEANROT, 5, 5, 5, 7, 7, 7, 99", False)):
        pilot = "*NODE\n99, 0., 0., 1.\n" if "99" in mpc else ""
        cards = body + pilot + f"*MPC\n{mpc}\n"
        plain, large, abaqus = (tables(cards + load.format(words), dialect)[-1].rows for words, dialect in
                                (("", "calculix"), (", NLGEOM", "calculix"), ("", "abaqus")))
        away = max(abs(a - b) for node in range(5, 9) for a, b in zip(plain[(node,)], large[(node,)], strict=True))
        assert (away < 1e-9) == is_turned_on, mpc
        away = max(abs(a - b) for node in range(5, 9) for a, b in zip(abaqus[(node,)], large[(node,)], strict=True))
        assert away > 1e-3, mpc


def test_rope(tables: Callable[..., list[Block]]) -> None:
    """MPC DIST: a spring of 100 along x and beside it a rope of 1.04 over a distance of 1: pulled with 10, with 2, and pushed with 5.

    Taut, the rope holds at 0.04 with a force of 6; slack, its force is zero. It stretches by its force over 1e4 E L.
    """
    text = CUBE + LINEAR + "*NODE\n11, 0., 0., 5.\n12, 1., 0., 5.\n13, 0., 0., 5.\n99, 1.04, 0., 0.\n*NSET, NSET=R\n12, 13\n"
    text += "*ELEMENT, TYPE=SPRINGA, ELSET=S\n9, 11, 12\n*SPRING, ELSET=S\n\n100.\n*BOUNDARY\n11, 1, 3\n13, 1, 3\n12, 2, 3\n"
    text += "*MPC\nDIST, 12, 12, 12, 13, 13, 13, 99\n*BOUNDARY\n99, 1\n"
    end = "*NODE PRINT, NSET=R\nU, RF\n*END STEP\n"
    text += "".join(f"*STEP\n*STATIC\n*CLOAD\n12, 1, {force}\n{end}" for force in (10.0, 2.0, -5.0))
    blocks = tables(text)
    for i, (moved, force) in enumerate(((0.04, 6.0), (0.02, 0.0), (-0.05, 0.0))):
        displacements, forces = blocks[2 * i : 2 * i + 2]
        assert displacements.rows[(12,)][0] == pytest.approx(moved, abs=2 * 6.0 / 1e7)
        assert forces.rows[(13,)][0] == pytest.approx(-force, abs=1e-4)


def test_creep_slows_down_by_the_end_of_the_increment(tables: Callable[..., list[Block]]) -> None:
    """Time hardening under constant stress: each increment adds A s^n t^m dt, t at its end, counted from where the creep began."""
    material = LINEAR.replace("*SOLID", "*CREEP\n1.E-6, 2., -.3\n*SOLID")
    load = "*CLOAD\n" + "".join(f"{n}, 1, 2.5\n" for n in (2, 3, 6, 7))
    out = "*EL PRINT, ELSET=E\nPEEQ\n*END STEP\n"
    blocks = tables(CUBE + material + f"*STEP\n*STATIC\n1.E-9, 1.E-9\n{load}*END STEP\n*STEP\n*VISCO, CETOL=1., DIRECT\n.5, 2.\n{out}")
    expected = 0.0
    for i, block in enumerate([b for b in blocks if b.time > 0.1], start=1):
        expected += 1e-6 * 10.0**2 * (0.5 * i) ** -0.3 * 0.5
        assert list(block.rows.values())[0][0] == pytest.approx(expected, rel=1e-4)


def test_pressure_of_a_node(tables: Callable[..., list[Block]]) -> None:
    """PnNP: the second prescribed displacement of a node is the pressure on a face, by its amplitude and over the steps; OP=NEW
    takes it away over the step. CalculiX has the same (its cube below shrinks by p/E, too)."""
    text = CUBE + LINEAR + "*NODE\n99, 5., 5., 5.\n*AMPLITUDE, NAME=A\n0., 0., .5, 1., 1., .5\n"
    end = "*EL PRINT, ELSET=E\nS\n*END STEP\n"
    head = "*STEP, NLGEOM\n*STATIC, DIRECT\n.5, 1.\n"
    text += head + "*BOUNDARY, AMPLITUDE=A\n99, 2, 2, 7.\n*DLOAD\nE, P2NP, 99\n" + end  # 7 at half the step, 3.5 at its end
    text += head + "*BOUNDARY\n99, 2, 2, 1.5\n" + end  # from 3.5 to 1.5
    text += head + end + head + "*DLOAD, OP=NEW\n" + end
    wanted = [7.0, 3.5, 2.5, 1.5, 1.5, 1.5, 0.75, 0.0]
    blocks = tables(text)
    assert len(blocks) == len(wanted)
    for block, pressure in zip(blocks, wanted, strict=True):
        for row in block.rows.values():
            assert row[2] == pytest.approx(-pressure, abs=0.01)  # Cauchy's stress, the pressure on the present face
            assert abs(row[0]) + abs(row[1]) < 1e-4


@pytest.mark.parametrize(("cards", "message"), [
    ("*DLOAD\nE, P2NP, 99\n", "no displacement 2 with a value is prescribed at the node 99"),
    ("*BOUNDARY, FIXED\n99, 2\n*DLOAD\nE, P2NP, 99\n", "no displacement 2 with a value is prescribed at the node 99"),
    ("*BOUNDARY\n99, 2, 2, 7.\n*DLOAD\nE, P2NP, N\n", "need one node, and elements of solids"),
    ("*BOUNDARY\n99, 2, 2, 7.\n*DLOAD\nE, P7NP, 99\n", "The second field must be P1 to P6"),
])  # fmt: skip
def test_pressure_of_a_node_refused(run_deck: Callable[..., object], cards: str, message: str) -> None:
    """What gives no pressure."""
    result = run_deck(CUBE + LINEAR + f"*NODE\n99, 5., 5., 5.\n*STEP\n*STATIC\n{cards}*END STEP\n", "--dialect=calculix")
    assert result.returncode == 3  # type: ignore[attr-defined]
    assert message in " ".join((result.stdout + result.stderr).split())  # type: ignore[attr-defined]
