"""CREEP of the user: power laws by the routine are our own laws, in all their numbers and iterations.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest
from scipy.optimize import brentq

from verify.conftest import Run
from verify.library.common import ROOT

ROUTINE = ROOT / "verify" / "library" / "routines" / "creep.f90"
A, N, M = 1e-16, 4.5, -0.4
USAGE, INPUT, SETUP, NOT_CONVERGED = 2, 3, 4, 5
LAWS = {"NORTON": f"*CREEP\n{A}, {N}, 0.\n", "STRAIN": f"*CREEP, LAW=STRAIN\n{A}, {N}, {M}\n",
        "WARM": f"*CREEP\n{A}, {N}, 0., 0.\n{3 * A}, {N}, 0., 200.\n"}  # fmt: skip


def deck(name: str, creep: str, *, kind: str = "C3D8", head: str = "", nlgeom: str = "", visco: str = "*VISCO, DIRECT\n2., 20.", yields: str = "") -> str:
    """A skew body that is pulled and sheared at once, held while it creeps, and pulled back."""
    space = "*NODE, NSET=ALL\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1.1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 1\n6, 1, 0.1, 1\n7, 1, 1, 1.2\n8, 0, 1, 1\n"
    body = f"{space}*ELEMENT, TYPE=C3D8, ELSET=E\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*NSET, NSET=LOW\n1, 2, 3, 4\n*NSET, NSET=TOP\n5, 6, 7, 8\n*BOUNDARY\nLOW, 1, 3\n"
    section, axis = "*SOLID SECTION, ELSET=E, MATERIAL={}\n", 3
    if kind != "C3D8":
        body = f"*NODE, NSET=ALL\n1, 1, 0\n2, 2, 0\n3, 2.1, 1\n4, 1, 1\n*ELEMENT, TYPE={kind}, ELSET=E\n1, 1, 2, 3, 4\n*NSET, NSET=LOW\n1, 2\n"
        body += "*NSET, NSET=TOP\n3, 4\n*BOUNDARY\nLOW, 1, 2\n"
        section, axis = "*SOLID SECTION, ELSET=E, MATERIAL={}\n1.\n", 2
    text = f"{head}{body}*MATERIAL, NAME={name}\n*ELASTIC\n200000., 0.3\n{yields}{creep}{section.format(name)}"
    text += "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 50.\n"
    for move, card in ((0.004, "*STATIC\n1., 1."), (0.004, visco), (0.002, visco)):
        text += f"*STEP, INC=1000{nlgeom}\n{card}\n*BOUNDARY\nTOP, 1, 1, {0.5 * move}\nTOP, {axis}, {axis}, {move}\n*END STEP\n"
    return text


def run_both(run: Run, folder: Path, name: str, **options: str) -> list[list[int]]:
    """Runs a deck with our law and with the routine; same fields, and the iterations of all increments of both."""
    (folder / "ours.inp").write_text(deck(name, LAWS[name], **options))
    (folder / "theirs.inp").write_text(deck(name, "*CREEP, LAW=USER\n", **options))
    for arguments in (["ours"], ["theirs", f"user={ROUTINE}"]):
        done = run(arguments, cwd=folder)
        assert done.returncode == 0, done.stdout + done.stderr
    with h5py.File(folder / "ours.vtkhdf") as ours, h5py.File(folder / "theirs.vtkhdf") as theirs:
        for field in [f for f in ("U", "RF", "S", "E", "LE") if f in ours["VTKHDF/PointData"]]:
            a, b = (f["VTKHDF/PointData"][field][:] for f in (ours, theirs))
            assert np.abs(a - b).max() <= 1e-9 * np.abs(a).max(), field
            assert np.abs(a).max() > 0
        frames = ours["VTKHDF/PointData/S"][:].reshape(-1, 4 if "kind" in options and options["kind"] != "C3D8" else 8, 6)
        assert np.abs(frames[2] - frames[1]).max() > 1e-4 * np.abs(frames[1]).max(), "the first increment of *VISCO creeps"
        return [f["AMONTONS/history/n_iterations"][:].tolist() for f in (ours, theirs)]


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("kind", ["C3D8", "CPE4", "CPE4R", "CPS4", "CAX4"])
@pytest.mark.parametrize("nlgeom", ["", ", NLGEOM"])
def test_power_laws(run: Run, tmp_path: Path, name: str, kind: str, nlgeom: str) -> None:
    """The same displacements, reactions, stresses and strains in the same iterations."""
    ours, theirs = run_both(run, tmp_path, name, kind=kind, nlgeom=nlgeom)
    assert ours == theirs


@pytest.mark.parametrize("options", [{"yields": "*PLASTIC\n150., 0.\n250., 0.1\n"}, {"visco": "*VISCO, CETOL=1e-5\n0.1, 20."},
                                     {"head": "** dialect: calculix\n"}, {"head": "** dialect: calculix\n", "nlgeom": ", NLGEOM"},
                                     {"head": "** dialect: calculix\n", "visco": "*VISCO, CETOL=1e-5\n0.1, 20."}],
                         ids=["yield", "cetol", "calculix", "calculix, nlgeom", "calculix, cetol"])  # fmt: skip
def test_beside_others(run: Run, tmp_path: Path, options: dict[str, str]) -> None:
    """With yield, with increments that CETOL limits, and in the calculix dialect, too. There CETOL compares rates of our law and
    increments of the routine, which are the same for m = 0."""
    ours, theirs = run_both(run, tmp_path, "NORTON", **options)
    assert ours == theirs


def stresses(run: Run, folder: Path, name: str, law: str, yields: str = "", words: tuple[str, ...] = ()) -> np.ndarray:
    """Stresses of all frames of a deck."""
    (folder / "job.inp").write_text(deck(name, law, yields=yields))
    done = run(["job", *words], cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    with h5py.File(folder / "job.vtkhdf") as result:
        return np.array(result["VTKHDF/PointData/S"])


def test_without_derivatives(run: Run, tmp_path: Path) -> None:
    """DECRA(1) alone: the same results."""
    ours = stresses(run, tmp_path, "NORTON", LAWS["NORTON"])
    bare = stresses(run, tmp_path, "BARE", "*CREEP, LAW=USER\n", words=(f"user={ROUTINE}",))
    assert np.abs(bare - ours).max() <= 1e-6 * np.abs(ours).max()


@pytest.mark.parametrize("level", [1e4, 150.0])
def test_strain_at_the_end(run: Run, tmp_path: Path, level: float) -> None:
    """A rate of the creep strain at the end, EC(2), for a bar that is held at once, without and with yield: the implicit equations,
    solved here by bisection. The rate falls so fast with the strain that no iteration by substitution converges."""
    sets = "*NSET, NSET=X0\n1, 4, 5, 8\n*NSET, NSET=Y0\n1, 2, 5, 6\n*NSET, NSET=Z0\n1, 2, 3, 4\n*NSET, NSET=TOP\n5, 6, 7, 8\n"
    cube = "*NODE, NSET=ALL\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 1\n6, 1, 0, 1\n7, 1, 1, 1\n8, 0, 1, 1\n"
    text = f"{cube}*ELEMENT, TYPE=C3D8, ELSET=E\n1, 1, 2, 3, 4, 5, 6, 7, 8\n{sets}*MATERIAL, NAME=SOLVED\n*ELASTIC\n200000., 0.3\n"
    text += f"*PLASTIC\n{level}, 0.\n*CREEP, LAW=USER\n*SOLID SECTION, ELSET=E, MATERIAL=SOLVED\n*BOUNDARY\nX0, 1\nY0, 2\nZ0, 3\n"
    text += "*STEP\n*STATIC\n1., 1.\n*BOUNDARY\nTOP, 3, 3, 0.0005\n*END STEP\n*STEP\n*VISCO, DIRECT\n1e3, 3e3\n*BOUNDARY\nTOP, 3, 3, 0.002\n*END STEP\n"
    (tmp_path / "job.inp").write_text(text)
    done = run(["job", f"user={ROUTINE}"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    with h5py.File(tmp_path / "job.vtkhdf") as result:
        found = np.array(result["VTKHDF/PointData/S"])[:, 2].reshape(-1, 8)[-3:, 0]
    plastic, crept, wanted = 0.0, 0.0, []
    for _ in range(3):

        def creep_at(q: float, crept: float = crept) -> float:
            return brentq(lambda c: c * (1 + (crept + c) / 1e-5) - 1e3 * A * q**N, 0, 1, xtol=1e-18, rtol=1e-14)

        q = brentq(lambda q, inelastic=plastic + crept: q - 200000 * (0.002 - inelastic - creep_at(q)), 1e-9, 400, xtol=1e-12)
        if q > level:
            q = level
            plastic += 0.002 - plastic - crept - creep_at(q) - q / 200000
        crept += creep_at(q)
        wanted.append(q)
    assert found == pytest.approx(wanted, rel=1e-8)


@pytest.mark.parametrize(("name", "said"), [("SWELLING", "swelling"), ("BACK", "negative increment")])
def test_what_is_no_creep_ends_the_job(run: Run, tmp_path: Path, name: str, said: str) -> None:
    """Swelling and a creep strain that shrinks are not computed wrongly: an error names them."""
    (tmp_path / "job.inp").write_text(deck(name, "*CREEP, LAW=USER\n"))
    done = run(["job", f"user={ROUTINE}"], cwd=tmp_path)
    assert done.returncode == NOT_CONVERGED
    assert said in done.stdout + done.stderr


def test_no_routine(run: Run, tmp_path: Path) -> None:
    """Without a file, and with one that has no CREEP."""
    (tmp_path / "job.inp").write_text(deck("NORTON", "*CREEP, LAW=USER\n"))
    done = run(["job"], cwd=tmp_path)
    assert done.returncode == USAGE
    assert "needs the user routine CREEP" in " ".join((done.stdout + done.stderr).split())
    (tmp_path / "other.f90").write_text("subroutine disp()\nend subroutine disp\n")
    done = run(["job", f"user={tmp_path / 'other.f90'}"], cwd=tmp_path)
    assert done.returncode == SETUP
    assert "CREEP" in done.stdout + done.stderr


@pytest.mark.parametrize("dialect", ["abaqus", "calculix"])
def test_closed_form(run: Run, tmp_path: Path, dialect: str) -> None:
    """A bar under a constant stress: e = sigma/E + A sigma^n t."""
    sets = "*NSET, NSET=X0\n1, 4, 5, 8\n*NSET, NSET=Y0\n1, 2, 5, 6\n*NSET, NSET=Z0\n1, 2, 3, 4\n*NSET, NSET=TOP\n5, 6, 7, 8\n"
    cube = "*NODE, NSET=ALL\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 1\n6, 1, 0, 1\n7, 1, 1, 1\n8, 0, 1, 1\n"
    text = f"** dialect: {dialect}\n{cube}*ELEMENT, TYPE=C3D8, ELSET=E\n1, 1, 2, 3, 4, 5, 6, 7, 8\n{sets}*MATERIAL, NAME=NORTON\n*ELASTIC\n200000., 0.3\n"
    text += "*CREEP, LAW=USER\n*SOLID SECTION, ELSET=E, MATERIAL=NORTON\n*BOUNDARY\nX0, 1\nY0, 2\nZ0, 3\n"
    text += "*STEP\n*STATIC\n1., 1.\n*CLOAD\nTOP, 3, 50.\n*END STEP\n*STEP\n*VISCO, DIRECT\n1., 5.\n*NODE PRINT, NSET=TOP\nU\n*END STEP\n"
    (tmp_path / "job.inp").write_text(text)
    done = run(["job", f"user={ROUTINE}"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    with h5py.File(tmp_path / "job.vtkhdf") as result:
        u = np.array(result["VTKHDF/PointData/U"])[-8:]
    assert u[4:, 2] == pytest.approx(200 / 200000 + A * 200**N * 5, rel=1e-8)


def test_manual(run: Run, tmp_path: Path) -> None:
    """The bar of the manual: e = sigma/E + sinh(sigma/50)/10000 t."""
    page = (ROOT / "doc" / "manual" / "user_routines.md").read_text().split("## CREEP\n")[1]
    for name, kind in (("my.f90", "fortran"), ("job.inp", "abaqus-creep")):
        (tmp_path / name).write_text(page.split(f"```{kind}\n")[1].split("```")[0])
    done = run(["job", "user=my.f90"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    with h5py.File(tmp_path / "job.vtkhdf") as result:
        u = np.array(result["VTKHDF/PointData/U"])[-8:]
    assert u[1, 0] == pytest.approx(100 / 200000 + 1e-4 * np.sinh(2) * 10, rel=1e-8)
