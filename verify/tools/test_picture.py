"""The picture of a job: in space and in the plane, with contact and without, with a rigid surface, unrolled; depth, counts and forces.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from amontons.report.data import Skin
from verify.conftest import ROOT, Run
from verify.decks.planes import flat_deck, flatten
from verify.decks.sheets import between, fix, pair, sheet, step
from verify.decks.solids import unit_cube
from verify.tools import picture, scene, slave_map

BALL = """*NODE
90, 0.5, 0.5, 3.
*SURFACE, TYPE=REVOLUTION, NAME=TOOL
0.5, 0.5, 3., 0.5, 0.5, 5.
START, 0., -2.
CIRCL, 2., 0., 0., 0.
*RIGID BODY, ANALYTICAL SURFACE=TOOL, REF NODE=90
"""
CUBE = unit_cube("N", "ALL") + """*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*SOLID SECTION, ELSET=ALL, MATERIAL=M
"""
TRUSS = """*NODE
11, 0, 0, 1
12, 0, 0, 3
*ELEMENT, TYPE=T3D2, ELSET=ROD
11, 11, 12
*SOLID SECTION, ELSET=ROD, MATERIAL=M
0.1
"""
PULL = "*STEP\n*STATIC\n*BOUNDARY\n1, 1, 3\n2, 2, 3\n3, 3\n4, 3\n5, 3, 3, 0.1\n6, 3, 3, 0.1\n7, 3, 3, 0.1\n8, 3, 3, 0.1\n"


def blocks() -> str:
    """One square pressed on another and dragged, CPE4."""
    upper, lower = flatten(sheet("UPPER", between(0, 1, 2), between(0, 1, 2))), flatten(sheet("LOWER", between(-1, 2, 6), between(-1, 0, 2)))
    steps = step(fix("LOWER_BOTTOM, 1, 2", "UPPER_TOP, 1", "UPPER_TOP, 2, 2, -0.01"), 1) + step(fix("UPPER_TOP, 1, 1, 0.05"), 2)
    return flat_deck([(upper, (1000.0, 0.3)), (lower, (1000.0, 0.3))], "CPE4", pair("UPPER_BOTTOM", "LOWER_TOP", 0.2) + steps)


@pytest.mark.parametrize(
    ("deck", "faces", "bars", "shells"),
    [
        (blocks(), 4 + 12, 0, 0),
        (CUBE + TRUSS + PULL + "11, 1, 3\n12, 1, 2\n12, 3, 3, 0.1\n*END STEP\n", 6, 1, 0),
        (TRUSS.replace("*SOLID", "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.3\n*SOLID") + "*STEP\n*STATIC\n*BOUNDARY\n11, 1, 3\n12, 1, 2\n12, 3, 3, 0.1\n*END STEP\n",
         0, 1, 0),
        (CUBE + BALL + PULL + "90, 1, 6\n*END STEP\n", 6, 0, None),
    ],
    ids=["plane contact", "solid and bar", "bar alone", "rigid ball"],
)
def test_it_is_drawn(run_deck: Run, tmp_path: Path, deck: str, faces: int, bars: int, shells: int | None) -> None:
    """What is seen: the outer faces of bodies, bars as lines, rigid surfaces as a net."""
    done = run_deck(deck, "--quiet")
    assert done.returncode == 0, done.stdout + done.stderr
    job = picture.read_job(tmp_path / "job.vtkhdf")
    tools = sum(scene.is_tool(job.data, ring[None])[0] for ring in job.data.skin.rings)
    assert (len(job.data.skin.rings) - tools, len(job.data.lines)) == (faces, bars)
    assert tools > 100 if shells is None else tools == shells
    assert picture.main([str(tmp_path / "job.vtkhdf"), "--output", str(tmp_path / "job.png")]) == 0
    assert (tmp_path / "job.png").stat().st_size > 5000
    figure, words = picture.shape(tmp_path / "job.vtkhdf")
    assert figure.axes
    assert "Mises" in words


def test_plane_bodies_are_seen_along_z() -> None:
    """x to the right, y up."""
    right, up, towards = picture.camera(np.array([[0.0, 0.0, 0.0], [2.0, 1.0, 0.0]]))
    assert np.array_equal([right, up, towards], np.eye(3))


def two_squares() -> SimpleNamespace:
    """Seen from (1, 1, 1): a small square, and behind it a large slanted one whose middle is nearer to the viewer."""
    right, up, towards = scene.camera(np.eye(3))
    small = [a * right + b * up for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    large = [a * right + b * up + depth * towards for a, b, depth in ((-2, -3, -3), (20, -3, 30), (20, 3, 30), (-2, 3, -3))]
    points = np.array(small + large)
    rings = [np.arange(4), np.arange(4, 8)]
    skin = Skin(rings=rings, corners=rings)
    return SimpleNamespace(points=points, skin=skin, labels=np.arange(1, 9), lines=np.zeros((0, 2), dtype=np.int64), is_plane=False)


def test_what_is_nearer_is_seen() -> None:
    """Point by point, not face by face: sorted by their middles the large square would cover the small one."""
    job = two_squares()
    towards = scene.camera(np.eye(3))[2]
    middles = [job.points[ring].mean(axis=0) @ towards for ring in job.skin.rings]
    assert middles[1] > middles[0]
    value = np.array([1.0] * 4 + [0.0] * 4)
    seen = job.points @ towards < 1e9
    seen[4:] = False
    image, _, _ = scene.render(job, job.points, value, 1.0, (300, 300), seen)
    red, green, blue = (float(v) for v in image[110:190, 60:120].reshape(-1, 3).mean(axis=0))
    assert red > 1.3 * blue and green > 1.3 * blue, "the small one is yellow; the large one would be violet"


def tube(n: int = 24, rows: int = 3, radius: float = 2.0, turn: float = 2 * np.pi) -> tuple[np.ndarray, list[np.ndarray]]:
    """Nodes and faces of a bore about an axis along y through (5, 0, 1)."""
    columns = n if turn > 6.28 else n + 1
    angle, height = np.meshgrid(np.arange(columns) * turn / n, np.arange(rows + 1.0), indexing="ij")
    points = np.stack([5 + radius * np.cos(angle), height, 1 + radius * np.sin(angle)], axis=2).reshape(-1, 3)
    node = np.arange(columns * (rows + 1)).reshape(columns, rows + 1)
    faces = [np.array([node[i, j], node[(i + 1) % columns, j], node[(i + 1) % columns, j + 1], node[i, j + 1]]) for i in range(n) for j in range(rows)]
    return points, faces


@pytest.mark.parametrize("turn", [2 * np.pi, np.pi], ids=["closed", "half"])
def test_a_bore_is_unrolled(turn: float) -> None:
    """Each face keeps its length around and along, the load lies in the middle, the seam opposite; no face is across the map."""
    points, faces = tube(turn=turn)
    job = SimpleNamespace(points=points, skin=Skin(rings=faces, corners=faces), is_plane=False)
    load = np.maximum(0.0, points[:, 2] - 1 - 1.5)   # pressed at the angle of 90 degrees
    pair = SimpleNamespace(nodes=np.arange(len(points)))
    chart = slave_map.map_of(job, pair, load)
    assert chart is not None
    assert (chart.remark, chart.labels) == ("unrolled", ("around", "y"))
    width = 2.0 * turn / 24
    for corners in chart.places:
        assert np.ptp(corners, axis=0) == pytest.approx([width, 1.0], rel=1e-9)
    places = np.concatenate(chart.places)
    assert np.ptp(places[:, 0]) == pytest.approx(2.0 * turn, rel=1e-9)
    top = int(np.argmax(load))
    assert chart.nodal[top][0][0] == pytest.approx(0.0, abs=1e-9)
    twice = [node for node, found in chart.nodal.items() if len(found) == 2]
    assert len(twice) == (4 if turn > 6 else 0), "the nodes of the seam"
    for node, directions in chart.directions.items():
        assert directions @ directions.T == pytest.approx(np.eye(2))
        assert directions[0] @ (points[node] - [5, points[node, 1], 1]) == pytest.approx(0.0, abs=1e-9)


def test_a_flat_surface_is_not_unrolled() -> None:
    """Nor one that is bent by a little."""
    points, faces = tube(turn=0.3)
    job = SimpleNamespace(points=points, skin=Skin(rings=faces, corners=faces), is_plane=False)
    chart = slave_map.map_of(job, SimpleNamespace(nodes=np.arange(len(points))), np.ones(len(points)))
    assert chart is not None and chart.remark == ""


@pytest.fixture(scope="module")
def bolt(run: Run, tmp_path_factory: pytest.TempPathFactory) -> tuple[picture.Job, str]:
    """The bolted joint of the manual, with three pairs; what its run printed."""
    folder = tmp_path_factory.mktemp("bolt")
    done = run(["--outdir", folder, ROOT / "input" / "bolted_joint.inp"])
    assert done.returncode == 0
    return picture.read_job(folder / "bolted_joint.vtkhdf"), done.stdout


def test_counts_are_those_of_the_terminal(bolt: tuple[picture.Job, str]) -> None:
    """Summed over the pairs."""
    job, printed = bolt
    counts = re.search(r"slave nodes at the end:  open (\d+),  stick (\d+),  slip (\d+)", printed)
    assert counts
    assert sum(pair.counts[-1] for pair in job.pairs).tolist() == [int(counts[k]) for k in (1, 2, 3)]
    for pair in job.pairs:
        assert np.bincount(pair.status[-1], minlength=3).tolist() == pair.counts[-1].tolist()


def test_friction_stays_below_its_limit(bolt: tuple[picture.Job, str]) -> None:
    """T of each pair is at most mu N; N of the head, whose normals are parallel, is the force of the pair."""
    job, _ = bolt
    assert [pair.name for pair in job.pairs] == ["HEAD on TOP", "NUT on BOTTOM", "JOINT_HIGH on JOINT_LOW"]
    for pair in job.pairs:
        assert pair.has_coulomb and pair.friction == 0.15
        assert np.all(pair.shear <= pair.friction * pair.normal * (1 + 1e-6) + 1e-9)
    head = job.data.pair_history["CFN"][job.data.pair_history["pair"] == 0]
    assert job.pairs[0].normal == pytest.approx(np.linalg.norm(head, axis=1), rel=1e-6)
    assert 10000 < job.pairs[0].normal[-1] < 10100


@pytest.mark.parametrize("axis", [0, 1, 2], ids=list("xyz"))
def test_a_section_is_seen_from_its_front(axis: int) -> None:
    """Its plane lies nearly in the paper, x or y to a side; what is upright stays upright, seen a little from above."""
    right, up, towards = scene.section_camera(axis)
    assert np.stack([right, up, towards]) @ np.stack([right, up, towards]).T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.cross(right, up) == pytest.approx(towards)
    assert towards[axis] > 0.85
    above = 2 if axis != 2 else 1
    assert right[above] == pytest.approx(0, abs=1e-12)
    assert up[above] > 0.85
    assert 0.2 < abs(towards[above]) < 0.5


def test_scenarios_are_drawn_where_there_are_any(bolt: tuple[picture.Job, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Statuses and scenarios have a column of the legend each, so that `none` is no status."""
    job, _ = bolt
    titles, legends = [], []

    def keep(figure: picture.plt.Figure, *_: object, **__: object) -> None:
        titles.append([axes.get_title(loc="left") for axes in figure.axes])
        legends.append([[text.get_text().split(" (")[0] for text in axes.get_legend().get_texts()] for axes in figure.axes if axes.get_legend()])

    monkeypatch.setattr(picture.plt.Figure, "savefig", keep)
    last = len(job.data.times) - 1
    scenario = job.pairs[0].scenario[last]
    before = scenario.copy()
    for values in (0, 2):
        scenario[:] = 0
        scenario[0] = values
        picture.draw(job, last, tmp_path / "job.png", pair=0)
    scenario[:] = before
    assert "Status" in titles[0] and "Status, and slip scenario last seen" in titles[1]
    assert picture.STATUS_NAMES in legends[0]
    assert [*picture.STATUS_NAMES, "", "", *picture.SCENARIO_NAMES] in legends[1]


def test_forces_stand_below_wide_bodies(bolt: tuple[picture.Job, str], run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Beside high ones; no axes cover each other."""
    assert run(["--quiet", "--outdir", tmp_path, ROOT / "input" / "press_fit.inp"]).returncode == 0
    places = []

    def keep(figure: picture.plt.Figure, *_: object, **__: object) -> None:
        figure.draw_without_rendering()
        places.append({axes.get_title(loc="left").split(",")[0]: axes.get_position() for axes in figure.axes})

    monkeypatch.setattr(picture.plt.Figure, "savefig", keep)
    for job in (picture.read_job(tmp_path / "press_fit.vtkhdf"), bolt[0]):
        picture.draw(job, len(job.data.times) - 1, tmp_path / "job.png")
    wide, high = places
    assert wide["Contact forces"].y1 < wide["Deformed shape"].y0
    assert wide["Contact forces"].x1 < wide["Status"].x0
    assert high["Contact forces"].x0 > high["Status"].x1 > high["Deformed shape"].x1


def test_sections_and_pairs_are_chosen(bolt: tuple[picture.Job, str], run_deck: Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """By the command line; wrong words are refused."""
    job, _ = bolt
    assert picture.section_of("y=2.5", job) == scene.Section(1, 2.5)
    assert picture.section_of("x", job) == scene.Section(0, 6.0), "bolt and plates reach from 0 to 12"
    assert run_deck(CUBE + PULL + "*END STEP\n", "--quiet").returncode == 0
    whole, cut = tmp_path / "whole.png", tmp_path / "cut.png"
    for output, more in ((whole, []), (cut, ["--section", "x=0.5"])):
        assert picture.main([str(tmp_path / "job.vtkhdf"), "--bodies", "--output", str(output), *more]) == 0
    assert whole.read_bytes() != cut.read_bytes()
    for wrong in (["--section", "w"], ["--pair", "1"], ["--increment", "99"]):
        assert picture.main([str(tmp_path / "job.vtkhdf"), *wrong]) == 2
    assert "there is no pair 1" in capsys.readouterr().err
