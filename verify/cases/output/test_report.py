"""The page of a job: what it says, that it loads nothing, and that a browser shows it without a complaint.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import base64
import re
import shutil
import signal
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest

from amontons.report import main, make_report, round_factor, sections, view_data
from amontons.report.charts import number
from amontons.report.data import Job, read_job
from verify.conftest import Run
from verify.decks import make_decks
from verify.decks.solids import KINDS, as_kind, node_set

BROWSER = next((path for name in ("chromium", "chromium-browser", "google-chrome") if (path := shutil.which(name))), None)
LOADS = r"""<(?:link|script|img|iframe|object|embed)[^>]*(?:src|href)=|@import|url\(|\bfetch\(|XMLHttpRequest|WebSocket|https?://"""


@pytest.fixture(scope="module")
def cubes(run: Run, root: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A job with contact."""
    folder = tmp_path_factory.mktemp("cubes")
    assert run(["--quiet", "--outdir", folder, root / "input" / "three_cubes.inp"]).returncode == 0
    return folder / "three_cubes.vtkhdf"


def bar(kind: str) -> str:
    """Two cells of a kind under tension, and a truss beside them."""
    solid = as_kind(make_decks.block([0.0, 1.0, 2.0], [0.0, 1.0], [0.0, 1.0], "BAR"), kind)
    left, right = (np.flatnonzero(np.abs(solid.nodes[:, 0] - x) < 1e-9) for x in (0.0, 2.0))
    n = len(solid.nodes)
    return (solid.cards() + node_set("LEFT", left) + node_set("RIGHT", right)
            + f"*NODE\n{n + 1}, 0., 2., 0.\n{n + 2}, 2., 2., 0.\n*NSET, NSET=ENDS\n{n + 1}, {n + 2}\n"
            + f"*ELEMENT, TYPE=T3D2, ELSET=ROD\n{len(solid.elements) + 1}, {n + 1}, {n + 2}\n"
            "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.3\n*SOLID SECTION, ELSET=ALL, MATERIAL=M\n"
            "*SOLID SECTION, ELSET=ROD, MATERIAL=M\n0.01\n"
            "*STEP\n*STATIC\n*BOUNDARY\nLEFT, 1, 3\nRIGHT, 1, 1, 0.01\nENDS, 1, 3\n*END STEP\n")  # fmt: skip


def enclosed_volume(job: Job) -> float:
    """Of the bodies, by Gauss's theorem over the triangles of the skin; the edges of quadratic faces are straight here."""
    a, b, c = (job.points[job.skin.triangles()[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


@pytest.mark.parametrize("kind", KINDS)
def test_skin_is_closed(run_deck: Run, tmp_path: Path, kind: str) -> None:
    """The outer faces of every kind enclose its volume, turned outward; a truss is a line."""
    assert run_deck(bar(kind), "--quiet").returncode == 0
    job = read_job(tmp_path / "job.vtkhdf")
    assert enclosed_volume(job) == pytest.approx(2.0, rel=1e-12)
    assert len(job.lines) == 1


def test_what_it_says(cubes: Path, program: Path) -> None:
    """The tables hold the numbers of the file; every card of the deck is listed; the page loads nothing."""
    job = read_job(cubes)
    cards = subprocess.run([program, "--cards"], capture_output=True, text=True, check=True).stdout
    page = make_report(job, cards)
    assert "All 2 steps are done" in page
    for title in ("Deformed bodies", "Contact at the last frame", "Forces and energies", "Convergence", "Slip scenarios",
                  "Largest values", "The deck, card by card"):  # fmt: skip
        assert title in page
    for card in ("*CONTACT PAIR", "*FRICTION", "*BOUNDARY", "*STATIC"):
        assert f"<td>{card}</td>" in page
    worst = int(np.argmax(job.fields["CPRESS"][-1]))
    assert f'data-node="{worst}">{job.labels[worst]}<' in page
    total = int(np.sum(job.history["n_iterations"]))
    assert f"{total} iterations" in page
    text = page[: page.index('id="job"')] + page[page.rindex("<script>") :]
    loads = [hit for hit in re.findall(LOADS, text) if hit != '<link rel="icon" href=']
    assert loads == []


def test_forces_of_sets(cubes: Path) -> None:
    """What LID takes FLOOR gives, and both are the force of contact; with sums of nothing the scale is that of single nodes."""
    job = read_job(cubes)
    sums = sections.set_reactions(job)
    lid, floor = (sums[name][-1] for name in ("LID", "FLOOR"))
    slave = np.asarray(job.history["slave_force"])[-1]
    np.testing.assert_allclose(lid, -floor, atol=1e-6 * np.abs(lid).max())
    np.testing.assert_allclose(floor, slave, atol=1e-6 * np.abs(lid).max())
    imbalance = re.findall(r'<td class="n">([^<]*)</td></tr>', sections.ledger(job).split("Reactions of the node sets")[0])
    assert len(imbalance) == 2 and max(map(float, imbalance)) < 1e-5


def test_materials_are_listed_by_their_cards() -> None:
    """What follows *MATERIAL, with what chooses the law; a number that was not given is no zero."""
    deck = "*MATERIAL, NAME=WOOD\n*ELASTIC, TYPE=ENGINEERING CONSTANTS\n1, 2\n*DENSITY\n1\n*STEP\n*STATIC\n*MATERIAL, NAME=m\n*PLASTIC\n"
    assert sections.material_cards(deck) == {"WOOD": "ELASTIC, TYPE=ENGINEERING CONSTANTS; DENSITY", "M": "PLASTIC"}
    assert sections.printed(0.0) == "-"


def test_bodies_apart_are_not_shown_in_each_other(run: Run, root: Path, cubes: Path, tmp_path: Path) -> None:
    """Displacements are enlarged where the bodies touch all over from the start, else not; and frame 0 has the gaps of the deck."""
    assert round_factor(read_job(cubes)) > 1.0
    assert run(["--quiet", "--outdir", tmp_path, root / "input" / "hertz_octant.inp"]).returncode == 0
    ball = read_job(tmp_path / "hertz_octant.vtkhdf")
    assert round_factor(ball) == 1.0
    gaps, heights = ball.fields["COPEN"][0][ball.slave_node], ball.points[ball.slave_node, 2]   # the plate is at z = 0
    np.testing.assert_allclose(gaps, heights, atol=1e-12 * heights.max())


def test_analytic_tool_and_skin_all_around(run_deck: Run, root: Path, tmp_path: Path) -> None:
    """A tool is drawn after the bodies, to be seen through; of a slave surface all around a cube only the closed face is mapped."""
    deck = next(text for text in (root / "doc" / "manual" / "contact.md").read_text().split("```abaqus\n") if "NAME=BALL" in text).split("```")[0]
    assert run_deck(deck.replace("1, S2", "1,", 1), "--quiet").returncode == 0
    job = read_job(tmp_path / "job.vtkhdf")
    view = view_data(job)
    n_triangles = len(base64.b64decode(view["triangles"])) // 12
    assert view["n_bodies"] == 12 < n_triangles
    closed = np.unique(job.slave_node[job.is_closed])
    assert set(closed) == set(np.flatnonzero((job.labels > 0) & (job.labels < 9) & (job.points[:, 2] == 1)))
    assert sections.maps(job).count("<polygon") == 3 + 4   # pressure, friction and slip of the face; the status of its four nodes


def test_status_of_each_node() -> None:
    """A face with one slipping node is a quarter slip; mid-side nodes count where they are slaves."""
    square, corners = np.array([0, 4, 1, 5, 2, 6, 3, 7]), np.array([0, 1, 2, 3])
    places = np.array([[0, 0], [2, 0], [2, 2], [0, 2], [1, 0], [2, 1], [1, 2], [0, 1]], dtype=float)
    status = np.array([2.0, 1, 1, 0, 1, 1, 1, 1])
    for ring, is_slave, expected in ((corners, corners, [2, 1, 1, 0]), (square, corners, [2, 1, 1, 0]), (square, square, [2, 1, 1, 1, 1, 1, 0, 1])):
        parts, values = sections.node_parts([(ring, corners)], [places[ring]], np.isin(np.arange(8), is_slave), status)
        assert values == expected
        areas = [0.5 * abs(float(np.sum(p[:, 0] * np.roll(p[:, 1], -1) - p[:, 1] * np.roll(p[:, 0], -1)))) for p in parts]
        assert sum(areas) == pytest.approx(4.0)


def test_energies_add_up(run_deck: Run, tmp_path: Path) -> None:
    """A free cube that falls on a table: the table of energies has the work of the unbalanced step; left out, it would be the rest.

    What does remain is the error of the trapezoidal rule in the one increment, in which the load drops the cube first and presses it then.
    """
    deck = ("*NODE\n1, 0., 0., 0.\n2, 1., 0., 0.\n3, 1., 1., 0.\n4, 0., 1., 0.\n5, 0., 0., 1.\n6, 1., 0., 1.\n7, 1., 1., 1.\n8, 0., 1., 1.\n"
            "11, -1., -1., -1.2\n12, 2., -1., -1.2\n13, 2., 2., -1.2\n14, -1., 2., -1.2\n15, -1., -1., -.2\n16, 2., -1., -.2\n17, 2., 2., -.2\n18, -1., 2., -.2\n"
            "*ELEMENT, TYPE=C3D8, ELSET=ALL\n1, 1, 2, 3, 4, 5, 6, 7, 8\n2, 11, 12, 13, 14, 15, 16, 17, 18\n*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.\n"
            "*SOLID SECTION, ELSET=ALL, MATERIAL=M\n*SURFACE, NAME=SOLE\n1, S1\n*SURFACE, NAME=TABLE\n2, S2\n*SURFACE INTERACTION, NAME=I\n"
            "*CONTACT PAIR, INTERACTION=I\nSOLE, TABLE\n*STEP\n*STATIC\n1., 1.\n*BOUNDARY\n11, 1, 3\n12, 1, 3\n13, 1, 3\n14, 1, 3\n"
            "1, 1, 2\n2, 2\n*CLOAD\n5, 3, -1.\n6, 3, -1.\n7, 3, -1.\n8, 3, -1.\n*END STEP\n")  # fmt: skip
    assert run_deck(deck, "--quiet").returncode == 0
    job = read_job(tmp_path / "job.vtkhdf")
    values = {name: float(job.history[name][-1]) for name in sections.ENERGIES}
    assert values["proximal_work"] > 0.5 * values["external_work"] > 0
    rest = values.pop("external_work") - sum(values.values())
    assert abs(rest) < 0.1 * values["proximal_work"]
    text = sections.ledger(job)
    assert "unbalanced steps" in text and number(values["proximal_work"]) in text
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        columns = {name for name, column in file["AMONTONS/history"].items() if "energy" in str(column.attrs["unit"])}
    assert columns == set(sections.ENERGIES), "the table has every energy of the file"


def test_command(cubes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The command writes the page; a foreign file is refused with exit code 7."""
    assert main([str(cubes), "--output", str(tmp_path / "page.html")]) == 0
    assert (tmp_path / "page.html").read_text().startswith("<!DOCTYPE html>")
    (tmp_path / "no.vtkhdf").write_text("nothing")
    assert main([str(tmp_path / "no.vtkhdf")]) == 7
    assert "*ERROR" in capsys.readouterr().err


def open_in_browser(address: str, folder: Path) -> tuple[str, str]:
    """The document after its scripts have run, and what the browser had to say."""
    done = subprocess.run(
        [BROWSER or "", "--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
         "--disable-background-networking", "--no-first-run", f"--user-data-dir={folder / 'profile'}", "--window-size=1200,1500",
         "--virtual-time-budget=5000", "--enable-logging=stderr", "--v=0", "--dump-dom", address],
        capture_output=True, text=True, timeout=240, check=False)  # fmt: skip
    return done.stdout, done.stderr


@pytest.mark.skipif(BROWSER is None, reason="Chromium is not installed (.ci/deps browser)")
@pytest.mark.parametrize("case", ["contact", "quadratic"])
@pytest.mark.slow
def test_in_a_browser(cubes: Path, run_deck: Run, tmp_path: Path, case: str) -> None:
    """The view is drawn, the console stays empty, and the page requests nothing from the network."""
    result = cubes
    if case == "quadratic":
        assert run_deck(bar("C3D20R"), "--quiet").returncode == 0
        result = tmp_path / "job.vtkhdf"
    page = tmp_path / "page.html"
    assert main([str(result), "--output", str(page)]) == 0
    document, log = open_in_browser(page.as_uri(), tmp_path)
    complaints = [line for line in log.splitlines() if "CONSOLE" in line]
    assert complaints == []
    assert re.search(r'data-drawn="[1-9]', document), "the view was not drawn: " + log[-1500:]
    assert 'data-requests="0"' in document
    assert '<p id="nogl" class="none" hidden' in document


def test_page_that_cannot_be_written(cubes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A page that cannot be written is reported in a sentence, and the old page stays."""
    import resource

    page = tmp_path / "page.html"
    page.write_text("the old one")
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    before = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, limits[1]))
    try:
        code = main([str(cubes), "--output", str(page)])
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        signal.signal(signal.SIGXFSZ, before)
    assert code == 7
    assert capsys.readouterr().err.startswith(f"*ERROR: The report {page} cannot be written: ")
    assert page.read_text() == "the old one"
    assert list(tmp_path.glob("*.new")) == []


def test_pair_sums(cubes: Path) -> None:
    """Forces of each pair at the end: the numbers of the table are those of the reactions of what it stands on."""
    job = read_job(cubes)
    text = sections.pair_sums(job)
    for slave, master in zip(job.pairs["slave"], job.pairs["master"], strict=True):
        assert f"{slave} on {master}" in text
    n = len(job.pairs["slave"])
    assert len(job.pair_history["pair"]) == n * (1 + int((job.history["is_converged"] == 1).sum()))  # the initial state too
    total = (job.pair_history["CFN"] + job.pair_history["CFS"])[-n:].sum(axis=0)
    assert total == pytest.approx(job.history["slave_force"][-1], rel=1e-12, abs=1e-12 * float(np.abs(total).max()))
    for value in job.pair_history["CFN"][-1]:
        if abs(value) > 1e-12 * np.abs(total).max():
            assert sections.number(float(value)) in text


def test_numbers_are_short() -> None:
    """They fit beside an axis."""
    assert [number(v) for v in (0.00025, 0.0015, 1e-3, -2.5e-4, 1.234567e-7, 12345.6, 0.0)] == ["2.5e-4", "0.0015", "0.001", "-2.5e-4", "1.235e-7", "1.235e4", "0"]
