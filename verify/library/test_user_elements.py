"""User elements (*USER ELEMENT, routine UEL): the same results as our own elements, fields, cut-backs, bad decks.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.conftest import Run
from verify.independent.results import read_field, read_history
from verify.library.common import ROOT, check_shorter_increments

UEL = ROOT / "verify" / "library" / "routines" / "uel.f90"
DECK_ERROR, USAGE, NOT_CONVERGED = 3, 2, 5
TRUSS = "*USER ELEMENT, TYPE=U1, NODES=2, COORDINATES=3, PROPERTIES=3, VARIABLES=2\n1, 2, 3\n"
ARCH = """*NODE, NSET=ALL
1, 0., 0., 0.
2, 10., 0., 1.
3, 20., 0., 0.
4, 10., 8., 0.
{elements}*BOUNDARY
1, 1, 3
3, 1, 3
4, 1, 3
{temperature}*STEP{nlgeom}
*STATIC
0.1, 1.
*CLOAD
2, 3, {load}
{more}*NODE PRINT, NSET=ALL
U
*END STEP
"""
ROWS = "1, 1, 2\n2, 2, 3\n3, 4, 2\n"
OURS = f"*ELEMENT, TYPE=T3D2, ELSET=BARS\n{ROWS}*MATERIAL, NAME=M\n*ELASTIC\n2000., 0.\n*EXPANSION\n1e-4\n*SOLID SECTION, ELSET=BARS, MATERIAL=M\n0.5\n"
THEIRS = f"{TRUSS}*ELEMENT, TYPE=U1, ELSET=BARS\n{ROWS}*UEL PROPERTY, ELSET=BARS\n2000., 0.5, 1e-4\n"


def arch(elements: str, *, nlgeom: bool, load: float, heat: float = 0.0) -> str:
    """Three bars to one node."""
    return ARCH.format(elements=elements, nlgeom=", NLGEOM" if nlgeom else "", load=load,
                       temperature="*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 0.\n" if heat else "",
                       more=f"*TEMPERATURE\nALL, {heat}\n" if heat else "")  # fmt: skip


@pytest.mark.parametrize(("nlgeom", "load", "heat"), [(False, -2.0, 0.0), (False, -2.0, 30.0), (True, -0.3, 0.0), (True, 9.0, 0.0)])
def test_trusses(nlgeom: bool, load: float, heat: float, run: Run, tmp_path: Path) -> None:
    """Displacements, reactions, iterations and strain energy are those of T3D2."""
    (tmp_path / "ours.inp").write_text(arch(OURS, nlgeom=nlgeom, load=load, heat=heat))
    (tmp_path / "theirs.inp").write_text(arch(THEIRS, nlgeom=nlgeom, load=load, heat=heat))
    for words in (["ours"], ["theirs", f"user={UEL}"]):
        done = run(words, cwd=tmp_path)
        assert done.returncode == 0, done.stdout + done.stderr
    ours, theirs = tmp_path / "ours.vtkhdf", tmp_path / "theirs.vtkhdf"
    for name in ("U", "RF"):
        a, b = read_field(ours, name)[-1], read_field(theirs, name)[-1]
        assert np.abs(a).max() > 1e-3
        assert np.abs(a - b).max() <= 1e-7 * np.abs(a).max(), name
    a, b = read_history(ours), read_history(theirs)
    assert a["n_iterations"].tolist() == b["n_iterations"].tolist()
    if not heat:
        assert np.abs(a["strain_energy"] - b["strain_energy"]).max() <= 1e-6 * a["strain_energy"].max()


def test_plane_elements(run: Run, tmp_path: Path) -> None:
    """CPE4 with 2 x 2 points (calculix dialect) and the same quadrilateral by UEL: distorted mesh, bending and shear, mixed with CPE4
    on the other half.
    """
    nodes = "\n".join(f"{1 + i + 6 * j}, {i + 0.2 * (j == 1) * (i % 2)}, {j + 0.1 * i}" for j in range(3) for i in range(6))
    rows = [f"{i + 5 * j + 1}, {1 + i + 6 * j}, {2 + i + 6 * j}, {8 + i + 6 * j}, {7 + i + 6 * j}" for j in range(2) for i in range(5)]
    head = f"*NODE, NSET=ALL\n{nodes}\n"
    tail = ("*BOUNDARY\n1, 1, 2\n7, 1, 2\n13, 1, 2\n*STEP\n*STATIC\n1., 1.\n*CLOAD\n6, 2, -1.\n12, 2, -2.\n18, 1, 3.\n*END STEP\n")
    material = "*MATERIAL, NAME=M\n*ELASTIC\n500., 0.3\n*SOLID SECTION, ELSET=OWN, MATERIAL=M\n0.7\n"
    own = "*ELEMENT, TYPE=CPE4, ELSET=OWN\n" + "\n".join(rows) + "\n"
    mixed = ("*ELEMENT, TYPE=CPE4, ELSET=OWN\n" + "\n".join(rows[:4]) + "\n*USER ELEMENT, TYPE=U2, NODES=4, PROPERTIES=3\n1, 2\n"
             "*ELEMENT, TYPE=U2, ELSET=USER\n" + "\n".join(rows[4:]) + "\n*UEL PROPERTY, ELSET=USER\n500., 0.3, 0.7\n")  # fmt: skip
    every = ("*USER ELEMENT, TYPE=U2, NODES=4, PROPERTIES=3\n1, 2\n*ELEMENT, TYPE=U2, ELSET=USER\n" + "\n".join(rows)
             + "\n*UEL PROPERTY, ELSET=USER\n500., 0.3, 0.7\n")  # fmt: skip
    (tmp_path / "own.inp").write_text("** dialect: calculix\n" + head + own + material + tail)
    (tmp_path / "every.inp").write_text(head + every + tail)
    (tmp_path / "mixed.inp").write_text(head + mixed + material + tail)
    results = {}
    for name in ("own", "every", "mixed"):
        done = run([name, *([f"user={UEL}"] if name != "own" else [])], cwd=tmp_path)
        assert done.returncode == 0, done.stdout + done.stderr
        results[name] = read_field(tmp_path / f"{name}.vtkhdf", "U")[-1]
    assert np.abs(results["every"] - results["own"]).max() <= 1e-9 * np.abs(results["own"]).max()
    # the CPE4 of the abaqus dialect have a mean dilatation, so that a mixed mesh is another one, though not by much
    assert 0 < np.abs(results["mixed"] - results["own"]).max() <= 0.1 * np.abs(results["own"]).max()
    with h5py.File(tmp_path / "every.vtkhdf") as file:
        assert set(file["VTKHDF/Types"][:].tolist()) == {2}  # VTK_POLY_VERTEX: UEL alone knows the shape


def test_field_on_another_degree_of_freedom(run: Run, tmp_path: Path) -> None:
    """Two bars with a field w on degree of freedom 4 that moves them: unsymmetric, w linear, u by hand. Kp = E A/L, c: coupling."""
    stiffness, field, coupling, w = 10.0, 4.0, 2.0, 0.5
    deck = f"""*NODE, NSET=ALL
1, 0., 0., 0.
2, 1., 0., 0.
3, 2., 0., 0.
*USER ELEMENT, TYPE=U3, NODES=2, COORDINATES=1, PROPERTIES=3, UNSYMM
1, 4
*ELEMENT, TYPE=U3, ELSET=E
1, 1, 2
2, 2, 3
*UEL PROPERTY, ELSET=E
{stiffness}, {field}, {coupling}
*BOUNDARY
1, 1, 1
1, 4, 4
3, 4, 4, {w}
*STEP
*STATIC
1., 1.
*NODE PRINT, NSET=ALL
U, UR
*END STEP
"""
    (tmp_path / "job.inp").write_text(deck)
    done = run(["job", f"user={UEL}"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    u = read_field(tmp_path / "job.vtkhdf", "U")[-1]
    # node 3: K (u3 - u2) = c w; node 2: K (u2 - u1) - K (u3 - u2) = c w/2
    u2 = 1.5 * coupling * w / stiffness
    assert np.abs(u[:3, 0] - [0, u2, u2 + coupling * w / stiffness]).max() <= 1e-12


def test_order_of_unknowns(run: Run, tmp_path: Path) -> None:
    """A second list that begins at node 1 again: all of degrees 1, then all of 4. The quadrilateral gets u1, u2 of node after node."""
    deck = arch(THEIRS.replace("1, 2, 3\n*ELEMENT", "1, 2, 3\n2, 1, 2, 3\n*ELEMENT", 1), nlgeom=True, load=-0.3)
    (tmp_path / "job.inp").write_text(deck)
    done = run(["job", f"user={UEL}"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    (tmp_path / "plain.inp").write_text(arch(THEIRS, nlgeom=True, load=-0.3))
    assert run(["plain", f"user={UEL}"], cwd=tmp_path).returncode == 0
    assert np.array_equal(read_field(tmp_path / "job.vtkhdf", "U")[-1], read_field(tmp_path / "plain.vtkhdf", "U")[-1])


def test_shorter_increments(run: Run, tmp_path: Path) -> None:
    """PNEWDT of UEL: increments above 30/1000 are refused and halved."""
    deck = arch(THEIRS.replace("PROPERTIES=3", "PROPERTIES=3, I PROPERTIES=1").replace("1e-4\n", "1e-4, 30\n"), nlgeom=False, load=-2.0)
    check_shorter_increments(run, tmp_path, deck, UEL, 0.03)


HEAD = """subroutine uel(rhs, amatrx, svars, energy, ndofel, nrhs, nsvars, props, nprops, coords, mcrd, nnode, u, du, v, a, jtype, time, &
  dtime, kstep, kinc, jelem, params, ndload, jdltyp, adlmag, predef, npredf, lflags, mlvarx, ddlmag, mdload, pnewdt, jprops, &
  njprop, period)
  include 'aba_param.inc'
  dimension rhs(mlvarx, *), amatrx(ndofel, ndofel), props(*), svars(*), u(ndofel), du(mlvarx, *), time(2), lflags(*)
"""
SLIDER = HEAD + """  force = 1000 * (u(2) - u(1) - svars(1))
  stiffness = 1000
  if (abs(force) > 10) then
    force = sign(10d0, force)
    svars(1) = u(2) - u(1) - force / 1000
    stiffness = 0.001d0
  end if
  if (time(2) > {end} .and. kinc > 0) call xit
  rhs(1, 1) = force
  rhs(2, 1) = -force
  amatrx(1, 1) = stiffness
  amatrx(2, 2) = stiffness
  amatrx(1, 2) = -stiffness
  amatrx(2, 1) = -stiffness
end subroutine uel
"""
CYCLE = """*NODE, NSET=ALL
1, 0.
2, 1.
*USER ELEMENT, TYPE=U1, NODES=2, COORDINATES=1, VARIABLES=1
1
*ELEMENT, TYPE=U1
1, 1, 2
*AMPLITUDE, NAME=CYCLE
0., 0., 0.25, 1., 0.75, -1., 1., 0.
*BOUNDARY
1, 1
*STEP
*STATIC, DIRECT
0.05, 1.
*BOUNDARY, AMPLITUDE=CYCLE
2, 1, 1, 0.03
*END STEP
"""


def test_memory_of_a_resumed_job(run: Run, tmp_path: Path) -> None:
    """A spring of 1000 that slides at 10, pulled to 0.03, pushed to -0.03 and back: +10, -10, and +10 again. A job that XIT ends in the
    middle resumes bitwise with a routine that does not.
    """
    for name, end in (("whole", 9.0), ("ends", 0.62)):
        (tmp_path / f"{name}.f90").write_text(SLIDER.format(end=f"{end}d0"))
    (tmp_path / "whole.inp").write_text(CYCLE)
    (tmp_path / "parts.inp").write_text(CYCLE)
    assert run(["whole", "user=whole.f90"], cwd=tmp_path).returncode == 0
    assert run(["parts", "user=ends.f90"], cwd=tmp_path).returncode == NOT_CONVERGED
    done = run(["--resume", "parts", "user=whole.f90"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    whole, parts = (np.array([rf[1, 0] for rf in read_field(tmp_path / f"{name}.vtkhdf", "RF")]) for name in ("whole", "parts"))
    assert np.array_equal(whole, parts)
    assert whole[[5, 15, 20]] == pytest.approx([10.0, -10.0, 10.0], rel=1e-9)
    assert whole[1] == pytest.approx(6.0, rel=1e-9)


@pytest.mark.parametrize("card", ["TYPE=U1, NODES=21", "TYPE=V1, NODES=2"])
def test_one_error_for_one_cause(card: str, run: Run, tmp_path: Path) -> None:
    """The elements of a type whose card is refused have no error of their own."""
    (tmp_path / "job.inp").write_text(arch(THEIRS.replace("TYPE=U1, NODES=2", card, 1), nlgeom=False, load=-2.0))
    done = run(["job", f"user={UEL}"], cwd=tmp_path)
    assert done.returncode == DECK_ERROR, done.stdout + done.stderr
    assert (done.stdout + done.stderr).count("job.inp:") == 1, done.stdout + done.stderr


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("NODES=2", "NODES=21", "at most 20 nodes"),
        ("TYPE=U1, NODES", "TYPE=V1, NODES", "TYPE must be U1 to U9999"),
        ("1, 2, 3\n*ELEMENT", "1, 2, 11\n*ELEMENT", "The degree of freedom 11 is not one of 1 to 6"),
        ("1, 2, 3\n*ELEMENT", "1, 2, 3\n3, 1\n*ELEMENT", "must be a node of the element, 1 to 2"),
        ("2000., 0.5, 1e-4", "2000., 0.5", "PROPERTIES=3 and I PROPERTIES=0; here are 2 values"),
        ("*UEL PROPERTY, ELSET=BARS\n2000., 0.5, 1e-4\n", "", "no *UEL PROPERTY names a set that holds them"),
        ("VARIABLES=2", "VARIABLES=2, LINEAR", "The routine UEL gives force and stiffness"),
        ("TYPE=U1, ELSET", "TYPE=U7, ELSET", "A user element needs *USER ELEMENT, TYPE=U7"),
        ("*STATIC\n0.1, 1.", "*STATIC, RIKS\n0.1, 1.", "user elements"),
        ("*STATIC\n0.1, 1.", "*DYNAMIC, APPLICATION=QUASI-STATIC\n0.1, 1.", "user elements"),
    ],
)  # fmt: skip
def test_errors(old: str, new: str, message: str, run: Run, tmp_path: Path) -> None:
    """Every error before the first step, with a sentence."""
    deck = arch(THEIRS, nlgeom=False, load=-2.0)
    assert deck.count(old) == 1
    (tmp_path / "job.inp").write_text(deck.replace(old, new))
    done = run(["job", f"user={UEL}"], cwd=tmp_path)
    assert done.returncode == DECK_ERROR, done.stdout + done.stderr
    assert message in " ".join((done.stdout + done.stderr).split())


def test_manual(run: Run, tmp_path: Path) -> None:
    """The spring of the manual: 1000 along (0.6, 0.8), of which 360 along x."""
    page = (ROOT / "doc" / "manual" / "user_routines.md").read_text().split("## UEL\n")[1]
    for name, kind in (("my.f90", "fortran"), ("job.inp", "abaqus-uel")):
        (tmp_path / name).write_text(page.split(f"```{kind}\n")[1].split("```")[0])
    done = run(["job", "user=my.f90"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    u = read_field(tmp_path / "job.vtkhdf", "U")[-1]
    assert np.abs(u - [[0, 0, 0], [0.1, 0, 0]]).max() <= 1e-13
    assert abs(read_history(tmp_path / "job.vtkhdf")["strain_energy"][-1] - 1.8) <= 1e-12


@pytest.mark.parametrize(
    ("statement", "words"),
    [
        ("rhs(ndofel + 3, 1) = 1", "it wrote number 9 of the array RHS, which has 6"),
        ("amatrx(:, ndofel + 1) = 1", "it wrote number 42 of the array AMATRX, which has 36"),
        ("svars(nsvars + 100) = 1", "it wrote number 102 of the array SVARS, which has 2"),
        ("energy(20) = 1", "it wrote number 20 of the array ENERGY, which has 8"),
        ("svars(k - 3) = 1", "it wrote number -2 of the array SVARS, which has 2"),
        ("predef(1, npredf + 3, nnode) = 1", "of the array PREDEF, which has 4"),
    ],
)
def test_writes_outside_of_arrays(statement: str, words: str, run: Run, tmp_path: Path) -> None:
    """A routine that writes outside of its arrays in the second increment: a message with routine, element and array."""
    place = "    svars(2) = svars(2) + 1\n"
    text = UEL.read_text()
    assert text.count(place) == 1
    (tmp_path / "wrong.f90").write_text(text.replace(place, f"{place}    k = nint(jtype + 0 * dtime)\n    if (kinc == 2 .and. jelem == 2) {statement}\n"))
    (tmp_path / "job.inp").write_text(arch(THEIRS, nlgeom=True, load=-0.3))
    done = run(["job", "user=wrong.f90"], cwd=tmp_path)
    assert done.returncode == NOT_CONVERGED, done.stdout + done.stderr
    assert "The routine UEL of wrong.f90 is wrong at element 2 in increment 2 of step 1" in done.stdout
    assert words in done.stdout


def test_parts(run: Run, tmp_path: Path) -> None:
    """A part with user elements and two instances: each as the deck without parts."""
    nodes, rest = ARCH.split("{elements}")
    part = nodes.replace(", NSET=ALL", "").replace("*NODE", "*PART, NAME=P\n*NODE") + THEIRS + "*END PART\n*ASSEMBLY, NAME=A\n"
    for name in ("I", "J"):
        part += f"*INSTANCE, NAME={name}, PART=P\n*END INSTANCE\n*NSET, NSET=FIX, INSTANCE={name}\n1, 3, 4\n*NSET, NSET=LOADED, INSTANCE={name}\n2\n"
    part += "*END ASSEMBLY\n*BOUNDARY\nFIX, 1, 3\n*STEP, NLGEOM\n*STATIC\n0.1, 1.\n*CLOAD\nLOADED, 3, -0.3\n*END STEP\n"
    (tmp_path / "parts.inp").write_text(part)
    (tmp_path / "plain.inp").write_text(arch(THEIRS, nlgeom=True, load=-0.3))
    for name in ("parts", "plain"):
        done = run([name, f"user={UEL}"], cwd=tmp_path)
        assert done.returncode == 0, done.stdout + done.stderr
    u, plain = (read_field(tmp_path / f"{name}.vtkhdf", "U")[-1] for name in ("parts", "plain"))
    assert np.abs(u - np.vstack([plain, plain])).max() <= 1e-12


def test_calculix_and_missing_file(run: Run, tmp_path: Path) -> None:
    """Of the elements that are compiled into CalculiX a beam is known alone; a job without a file names the routine."""
    deck = arch(THEIRS, nlgeom=False, load=-2.0)
    (tmp_path / "job.inp").write_text(deck)
    done = run(["job"], cwd=tmp_path)
    assert done.returncode == USAGE
    assert "*USER ELEMENT needs the user routine UEL" in " ".join((done.stdout + done.stderr).split())
    (tmp_path / "job.inp").write_text("** dialect: calculix\n" + deck)
    done = run(["job", f"user={UEL}"], cwd=tmp_path)
    assert done.returncode == DECK_ERROR
    assert "Of the user elements of CalculiX, which are compiled into it, only the beam" in " ".join((done.stdout + done.stderr).split())
