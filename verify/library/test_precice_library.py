"""The preCICE adapter with preCICE itself: two participants, each a process, coupled over sockets.

Tried with preCICE 3.4.1 and pyprecice 3.4.0; skipped where the Python bindings cannot be imported. doc/manual/library.md explains how
preCICE is built. References: bars in a row in closed form; a flap in a stream against one job that has the stream as springs.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

import amontons
from verify.conftest import ROOT
from verify.library.common import frames
from verify.library.test_precice import LOWER, TWO_STEPS, UPPER

PROBE = "import precice; print(precice.get_version_information().decode())"
WAIT = 120  #: [s] for both participants

CONFIGURATION = """<?xml version="1.0" encoding="UTF-8" ?>
<precice-configuration>
  <log><sink type="stream" output="stdout" filter="%Severity% > debug" enabled="true" /></log>
  <data:vector name="Displacement" />
  <data:vector name="Force" />
  <mesh name="A" dimensions="{dimensions}"> <use-data name="Displacement" /> <use-data name="Force" /> </mesh>
  <mesh name="B" dimensions="{dimensions}"> <use-data name="Displacement" /> <use-data name="Force" /> </mesh>
  <participant name="{first}">
    <provide-mesh name="A" />
    <write-data name="Displacement" mesh="A" />
    <read-data name="Force" mesh="A" />
  </participant>
  <participant name="{second}">
    <provide-mesh name="B" />
    <receive-mesh name="A" from="{first}" />
    <write-data name="Force" mesh="B" />
    <read-data name="Displacement" mesh="B" />
    <mapping:nearest-neighbor direction="read" from="A" to="B" constraint="consistent" />
    <mapping:nearest-neighbor direction="write" from="B" to="A" constraint="conservative" />
  </participant>
  <m2n:sockets acceptor="{first}" connector="{second}" exchange-directory="." network="lo" />
  <coupling-scheme:{scheme}>
    <participants first="{first}" second="{second}" />
    <max-time-windows value="{windows}" />
    <time-window-size value="{length}" />
    <exchange data="Displacement" mesh="A" from="{first}" to="{second}" />
    <exchange data="Force" mesh="A" from="{second}" to="{first}" {initialize}/>
{rest}  </coupling-scheme:{scheme}>
</precice-configuration>
"""
IMPLICIT = """    <max-iterations value="60" />
    <relative-convergence-measure limit="1e-10" data="Displacement" mesh="A" />
    <relative-convergence-measure limit="1e-10" data="Force" mesh="A" />
    <acceleration:IQN-ILS>
      <data name="Force" mesh="A" />
      <initial-relaxation value="0.3" />
      <max-used-iterations value="20" />
      <time-windows-reused value="2" />
      <filter type="QR2" limit="1e-3" />
    </acceleration:IQN-ILS>
"""
NODES = {"read-data": ["Force"], "write-data": ["Displacement"]}


@pytest.fixture(scope="module", autouse=True)
def precice() -> str:
    """The version of preCICE."""
    if find_spec("precice") is None:
        pytest.skip("preCICE's Python bindings are not installed")
    done = subprocess.run([sys.executable, "-c", PROBE], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        pytest.skip(f"preCICE cannot be loaded: {done.stderr.strip()[-200:]}")
    return done.stdout.split(";")[0]


def environment(library: Path) -> dict[str, str]:
    """Where the participants find the package and the library."""
    return os.environ | {"PYTHONPATH": str(ROOT / "python"), "AMONTONS_LIBRARY": str(library), "OMP_NUM_THREADS": "1"}


def together(commands: list[list[str]], folder: Path, library: Path) -> list[str]:
    """Runs both participants at once; what they print. Both must end well."""
    running = [subprocess.Popen([sys.executable, *words], cwd=folder, env=environment(library), stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                text=True) for words in commands]  # fmt: skip
    printed = []
    try:
        printed = [one.communicate(timeout=WAIT)[0] for one in running]
    finally:
        for one in running:
            if one.poll() is None:
                one.kill()
    for one, text in zip(running, printed, strict=True):
        assert one.returncode == 0, text[-4000:]
    return printed


def couple(folder: Path, library: Path, decks: dict[str, str], *, interfaces: dict[str, list[dict]], **settings: object) -> list[str]:
    """Couples two decks by the command of the adapter."""
    names = list(decks)
    values = {"dimensions": 3, "scheme": "serial-implicit", "windows": 4, "length": 0.25, "rest": IMPLICIT, "initialize": ""} | settings
    (folder / "precice.xml").write_text(CONFIGURATION.format(first=names[0], second=names[1], **values))
    words = {"precice-config-file": "precice.xml", "participants": {name: {"interfaces": interfaces[name]} for name in names}}
    (folder / "config.json").write_text(json.dumps(words))
    for name, deck in decks.items():
        (folder / f"{name}.inp").write_text(deck)
    return together([["-m", "amontons.precice", f"{name}.inp", "config.json", name] for name in names], folder, library)


BARS = {
    "Lower": [{"nodes-mesh": "A", "patch": "HIGH", **NODES}],
    "Upper": [{"nodes-mesh": "B", "patch": "LOW", "read-data": ["Displacement"], "write-data": ["Force"]}],
}


def heights(path: Path) -> np.ndarray:
    """Displacement along z of the nodes 5 to 8 at each frame."""
    return np.array([frame["U"][4:8, 2] for frame in frames(path)])


def test_two_bars_in_a_row(tmp_path: Path, library: Path) -> None:
    """E = 1000 takes forces, E = 250 displacements; its end is drawn by 0.02: where they meet 0.02 * 250/1250, along a straight line."""
    printed = couple(tmp_path, library, {"Lower": LOWER, "Upper": UPPER}, interfaces=BARS)
    u = heights(tmp_path / "Lower.vtkhdf")
    assert u[:, 0] == pytest.approx(0.004 * np.linspace(0, 1, 5), rel=1e-8, abs=1e-14)
    assert np.ptp(u, axis=1).max() < 1e-12
    assert "Time window completed" in printed[0]
    assert "*ERROR" not in "".join(printed)


def test_a_step_ends_within_a_window(tmp_path: Path, library: Path) -> None:
    """Windows of 0.2 over decks with two steps of 0.5: the third is solved in two pieces (preCICE's subcycling)."""
    lower = LOWER[: LOWER.index("*STEP")] + TWO_STEPS.format(held="ALL, 1, 2\nLOW, 3, 3", more="LOW, 3, 3")
    upper = UPPER[: UPPER.index("*STEP")] + TWO_STEPS.format(held="ALL, 1, 2\nHIGH, 3, 3, 0.01\nLOW, 3, 3, 0.", more="HIGH, 3, 3, 0.02")
    couple(tmp_path, library, {"Lower": lower, "Upper": upper}, interfaces=BARS, windows=5, length=0.2)
    u = heights(tmp_path / "Lower.vtkhdf")   # a frame for each window
    assert u[:, 0] == pytest.approx(0.004 * np.linspace(0, 1, 6), rel=1e-8, abs=1e-14)


def test_explicit_coupling(tmp_path: Path, library: Path) -> None:
    """Each window once, Lower first: it has the force of the window before, u_k = F_(k-1)/1000 with F_k = 250 (0.005 k - u_k)."""
    couple(tmp_path, library, {"Lower": LOWER, "Upper": UPPER}, interfaces=BARS, scheme="serial-explicit", rest="")
    u, force = [0.0], 0.0
    for k in range(4):
        u.append(force / 1000)
        force = 250 * (0.005 * (k + 1) - u[-1])
    assert heights(tmp_path / "Lower.vtkhdf")[:, 0] == pytest.approx(u, rel=1e-9, abs=1e-14)


PLANE = """*NODE, NSET=ALL
5, 0, {y0}
6, 1, {y0}
7, 1, {y1}
8, 0, {y1}
*ELEMENT, TYPE=CPS4, ELSET=BAR
1, 5, 6, 7, 8
*NSET, NSET=LOW
5, 6
*NSET, NSET=HIGH
8, 7
*MATERIAL, NAME=M
*ELASTIC
{E}, 0
*SOLID SECTION, ELSET=BAR, MATERIAL=M
*STEP
*STATIC
0.25, 1
*BOUNDARY
ALL, 1
{held}
*END STEP
"""


def test_plane_meshes(tmp_path: Path, library: Path) -> None:
    """The same bars in the plane: displacements are read, too, from meshes of two dimensions."""
    decks = {"Lower": PLANE.format(y0=0, y1=1, E=1000, held="LOW, 2"),
             "Upper": PLANE.format(y0=1, y1=2, E=250, held="HIGH, 2, 2, 0.02\nLOW, 2, 2, 0.")}  # fmt: skip
    couple(tmp_path, library, decks, interfaces=BARS, dimensions=2)
    for name, row in (("Lower", 3), ("Upper", 0)):
        u = np.array([frame["U"][row, 1] for frame in frames(tmp_path / f"{name}.vtkhdf")])
        assert u == pytest.approx(0.004 * np.linspace(0, 1, 5), rel=1e-8, abs=1e-14), name


STREAM = """
import sys
import numpy as np
import precice

p0, k, area, nodes = float(sys.argv[1]), float(sys.argv[2]), np.loadtxt("area.txt"), np.loadtxt("nodes.txt")
stream = precice.Participant("Stream", "precice.xml", 0, 1)
ids = stream.set_mesh_vertices("B", nodes)
now = 0.0
if stream.requires_initial_data():
    stream.write_data("B", "Force", ids, np.zeros_like(nodes))
stream.initialize()
while stream.is_coupling_ongoing():
    if stream.requires_writing_checkpoint():
        kept = now
    dt = stream.get_max_time_step_size()
    u = stream.read_data("B", "Displacement", ids, dt)
    now += dt
    stream.write_data("B", "Force", ids, np.column_stack([area * (p0 * now - k * u[:, 0]), 0 * area]))
    stream.advance(dt)
    if stream.requires_reading_checkpoint():
        now = kept
stream.finalize()
"""


def flap(n: int, springs: str = "", loads: str = "") -> str:
    """A flap of 0.1 by 1 across a stream, plane strain, of n elements with 8 nodes along its height, clamped below; NLGEOM."""
    xs, ys = np.linspace(0, 0.1, 5), np.linspace(0, 1, 2 * n + 1)
    lines = ["*NODE, NSET=ALL", *(f"{10 * j + i + 1}, {x:.6f}, {y:.6f}" for j, y in enumerate(ys) for i, x in enumerate(xs) if i % 2 == 0 or j % 2 == 0)]
    lines.append("*ELEMENT, TYPE=CPE8, ELSET=FLAP")
    for j in range(n):
        for i in range(2):
            a = 20 * j + 2 * i + 1
            lines.append(f"{2 * j + i + 1}, {a}, {a + 2}, {a + 22}, {a + 20}, {a + 1}, {a + 12}, {a + 21}, {a + 10}")
    lines += ["*NSET, NSET=WET", *(str(10 * j + 1) for j in range(1, 2 * n + 1)), "*NSET, NSET=ROOT", "1, 2, 3, 4, 5"]
    lines += ["*MATERIAL, NAME=SOFT", "*ELASTIC", "4.e3, 0.3", "*SOLID SECTION, ELSET=FLAP, MATERIAL=SOFT", springs]
    lines += ["*STEP, NLGEOM", "*STATIC", "0.25, 1.", "*BOUNDARY", "ROOT, 1, 2", loads, "*END STEP", ""]
    return "\n".join(line for line in lines if line)


@pytest.mark.parametrize("scheme", ["serial-implicit", "parallel-implicit"])
def test_flap_in_a_stream(tmp_path: Path, library: Path, scheme: str) -> None:
    """A flap under a pressure that falls as it gives way, p = p0 t - k u, in 2D with large displacements, as the perpendicular flap of
    preCICE's tutorials; the stream is a program of its own. One job with the same forces and springs gives the same displacements."""
    n, p0, k = 8, 3.0, 10.0
    area = np.tile([4 / 6, 2 / 6], n) / n
    area[-1] = 1 / 6 / n
    wet = 10 * np.arange(1, 2 * n + 1) + 1
    np.savetxt(tmp_path / "area.txt", area)
    np.savetxt(tmp_path / "nodes.txt", np.column_stack([0 * area, np.linspace(0, 1, 2 * n + 1)[1:]]))
    (tmp_path / "stream.py").write_text(STREAM)
    (tmp_path / "Solid.inp").write_text(flap(n))
    rest = IMPLICIT.replace("</acceleration", '  <data name="Displacement" mesh="A" />\n    </acceleration') if scheme[0] == "p" else IMPLICIT
    (tmp_path / "precice.xml").write_text(CONFIGURATION.format(first="Solid", second="Stream", dimensions=2, scheme=scheme, windows=4,
                                                              length=0.25, rest=rest, initialize=""))  # fmt: skip
    words = {"precice-config-file": "precice.xml", "participants": {"Solid": {"interfaces": [{"nodes-mesh": "A", "patch": "WET", **NODES}]}}}
    (tmp_path / "config.json").write_text(json.dumps(words))
    printed = together([["-m", "amontons.precice", "Solid.inp", "config.json", "Solid"], ["stream.py", str(p0), str(k)]], tmp_path, library)
    springs = "\n".join(f"*ELEMENT, TYPE=SPRING1, ELSET=S{node}\n{1000 + node}, {node}\n*SPRING, ELSET=S{node}\n1\n{k * a:.16g}"
                        for node, a in zip(wet, area, strict=True))  # fmt: skip
    loads = "*CLOAD\n" + "\n".join(f"{node}, 1, {p0 * a:.16g}" for node, a in zip(wet, area, strict=True))
    with amontons.Job(text=flap(n, springs, loads)) as job:
        job.run()
        expected = job.get("U", "WET")
    found = frames(tmp_path / "Solid.vtkhdf")[-1]["U"]
    with amontons.Job(text=flap(n), check=True) as job:
        rows = np.searchsorted(job.nodes(), job.nodes("WET"))
    assert abs(expected[-1, 0]) > 0.05   # it bends by more than half its thickness
    assert np.abs(found[rows] - expected).max() < 1e-6 * np.abs(expected).max()
    iterations = [int(i) for i in re.findall(r"Iterations?:? *(\d+)", "".join(printed))]
    assert not iterations or max(iterations) < 60
