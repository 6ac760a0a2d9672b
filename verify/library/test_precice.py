"""The preCICE adapter with two participants, against a stand-in with the calls of preCICE's Python bindings.

precice_stand_in.py says what it does. test_precice_library.py runs preCICE itself, where it is installed.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import json
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

import amontons
from amontons.precice import Adapter, Interface, main, read_configuration
from verify.library import precice_stand_in
from verify.library.common import ROOT  # noqa: F401  (finds the package)

BAR = """\
*NODE, NSET=ALL
1, 0, 0, {z0}
2, 1, 0, {z0}
3, 1, 1, {z0}
4, 0, 1, {z0}
5, 0, 0, {z1}
6, 1, 0, {z1}
7, 1, 1, {z1}
8, 0, 1, {z1}
*ELEMENT, TYPE=C3D8, ELSET=BAR
1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=LOW
1, 2, 3, 4
*NSET, NSET=HIGH
5, 6, 7, 8
*SURFACE, NAME=LID
BAR, S2
*MATERIAL, NAME=M
*ELASTIC
{E}, 0
*EXPANSION
1e-3
*SOLID SECTION, ELSET=BAR, MATERIAL=M
*INITIAL CONDITIONS, TYPE=TEMPERATURE
ALL, 0.
*STEP
*STATIC
0.25, 1
*BOUNDARY
ALL, 1, 2
{held}
*END STEP
"""
PARTICIPANTS: dict[str, precice_stand_in.Participant] = {}  #: of the last coupling
LOWER = BAR.format(z0=0, z1=1, E=1000, held="LOW, 3, 3")
UPPER = BAR.format(z0=1, z1=2, E=250, held="HIGH, 3, 3, 0.02\nLOW, 3, 3, 0.")


def couple(exchange: precice_stand_in.Exchange, decks: dict[str, str], interfaces: dict[str, list[dict]]) -> dict[str, amontons.Job]:
    """Runs both participants, each in its thread; the jobs, at their end."""
    precice_stand_in.EXCHANGES["here"] = exchange
    configuration = {"precice-config-file": "here", "participants": {n: {"interfaces": w} for n, w in interfaces.items()}}
    jobs = {name: amontons.Job(text=deck) for name, deck in decks.items()}
    errors: list[BaseException] = []

    def run(name: str) -> None:
        try:
            adapter = Adapter(jobs[name], configuration, name, precice=precice_stand_in)
            PARTICIPANTS[name] = adapter.participant
            adapter.run()
        except BaseException as error:  # noqa: BLE001
            errors.append(error)
            exchange.barrier.abort()

    threads = [threading.Thread(target=run, args=(name,)) for name in jobs]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    if errors:
        raise errors[0]
    return jobs


def test_two_bars_in_a_row() -> None:
    """The lower bar (E = 1000) takes forces, the upper one (E = 250) displacements; its end is drawn by 0.02: where they
    meet 0.02 * 250/1250. In each of four windows the loads repeat until they stand; the histories are straight lines."""
    exchange = precice_stand_in.Exchange(4, 0.25, relaxation=0.5)
    jobs = couple(exchange, {"Lower": LOWER, "Upper": UPPER}, {
        "Lower": [{"nodes-mesh": "A", "patch": "HIGH", "read-data": ["Force"], "write-data": ["Displacement"]}],
        "Upper": [{"nodes-mesh": "B", "patch": "LOW", "read-data": ["Displacement"], "write-data": ["Force"]}]})  # fmt: skip
    assert len(exchange.iterations) == 4
    assert max(exchange.iterations) < 100
    assert min(exchange.iterations) > 2
    for job, patch in ((jobs["Lower"], "HIGH"), (jobs["Upper"], "LOW")):
        assert job.is_done
        assert job.get("U", patch)[:, 2] == pytest.approx(0.02 * 250 / 1250, rel=1e-8)
    assert jobs["Upper"].get("RF", "HIGH")[:, 2].sum() == pytest.approx(250 * 0.016, rel=1e-8)


TWO_STEPS = "*STEP\n*STATIC\n0.25, 0.5\n*BOUNDARY\n{held}\n*END STEP\n*STEP\n*STATIC\n0.25, 0.5\n*BOUNDARY\n{more}\n*END STEP\n"


def test_a_step_ends_within_a_window() -> None:
    """Windows of 0.2 over decks with two steps of 0.5: the third window is solved in two pieces. All is linear: the same end, and
    at each end of a window the same straight line as above."""
    two = LOWER[: LOWER.index("*STEP")] + TWO_STEPS.format(held="ALL, 1, 2\nLOW, 3, 3", more="LOW, 3, 3")
    lid = UPPER[: UPPER.index("*STEP")] + TWO_STEPS.format(held="ALL, 1, 2\nHIGH, 3, 3, 0.01\nLOW, 3, 3, 0.", more="HIGH, 3, 3, 0.02")
    exchange = precice_stand_in.Exchange(5, 0.2, relaxation=0.5)
    jobs = couple(exchange, {"Lower": two, "Upper": lid}, {
        "Lower": [{"nodes-mesh": "A", "patch": "HIGH", "read-data": ["Force"], "write-data": ["Displacement", "Position"]}],
        "Upper": [{"nodes-mesh": "B", "patch": "LOW", "read-data": ["Displacement"], "write-data": ["Force"]}]})  # fmt: skip
    assert len(exchange.iterations) == 5
    for name in ("Lower", "Upper"):
        pieces = PARTICIPANTS[name].pieces
        assert sum(abs(piece - 0.1) < 1e-9 for piece in pieces) == 2 * exchange.iterations[2]
        assert sum(abs(piece - 0.2) < 1e-9 for piece in pieces) == sum(exchange.iterations) - exchange.iterations[2]
        assert jobs[name].is_done
    assert jobs["Lower"].get("U", "HIGH")[:, 2] == pytest.approx(0.02 * 250 / 1250, rel=1e-8)
    assert exchange.data["Position"][:, 2] == pytest.approx(1 + 0.02 * 250 / 1250, rel=1e-8)
    assert jobs["Upper"].get("RF", "HIGH")[:, 2].sum() == pytest.approx(250 * 0.016, rel=1e-8)


def test_explicit_coupling_and_initial_data() -> None:
    """Each window once, no checkpoints: what is read is one window behind, u_k = -F_(k-1)/1000 with F_k = 250 (0.005 k - u_(k-1))."""
    exchange = precice_stand_in.Exchange(4, 0.25, is_implicit=False, needs_initial=True)
    jobs = couple(exchange, {"Lower": LOWER, "Upper": UPPER}, {
        "Lower": [{"nodes-mesh": "A", "patch": "HIGH", "read-data": ["Force"], "write-data": ["Displacement"]}],
        "Upper": [{"nodes-mesh": "B", "patch": "LOW", "read-data": ["Displacement"], "write-data": ["Force"]}]})  # fmt: skip
    u, force = 0.0, 0.0
    for k in range(4):
        u, force = force / 1000, 250 * (0.005 * (k + 1) - u)
    assert exchange.iterations == [1, 1, 1, 1]
    assert jobs["Lower"].get("U", "HIGH")[:, 2] == pytest.approx(u, rel=1e-9)
    assert jobs["Upper"].get("RF", "HIGH")[:, 2].sum() == pytest.approx(force, rel=1e-9)


def test_the_deck_ends_before_the_coupling() -> None:
    """The message names the remedy."""
    with pytest.raises(amontons.UsageError, match="end at time 1; the coupling continues"):
        couple(precice_stand_in.Exchange(3, 0.5), {"Lower": LOWER, "Upper": UPPER}, {
            "Lower": [{"nodes-mesh": "A", "patch": "HIGH", "read-data": ["Force"], "write-data": ["Displacement"]}],
            "Upper": [{"nodes-mesh": "B", "patch": "LOW", "read-data": ["Displacement"], "write-data": ["Force"]}]})  # fmt: skip


def test_patches_as_calculix_names_them() -> None:
    """patch: interface means the node set Ninterface, the surface Sinterface; mesh is a faces-mesh."""
    deck = LOWER.replace("NSET=HIGH", "NSET=NinterFace").replace("NAME=LID", "NAME=Sinterface")
    with amontons.Job(text=deck) as job:
        for words, patch, n in (({"nodes-mesh": "A"}, "Ninterface", 4), ({"faces-mesh": "A"}, "Sinterface", 1), ({"mesh": "A"}, "Sinterface", 1)):
            face = Interface.of({**words, "patch": "interface"}, job)
            assert (face.patch, len(face.places), face.is_faces) == (patch, n, n == 1)


def test_pressure_temperature_and_deltas() -> None:
    """One participant gives pressure on faces and temperature, the other takes them: du = T alpha - p/E."""

    class Wall:
        """Sends the data of a flow, and receives the displacements."""

        heard: list[float] = []

        def run(self) -> None:
            participant = precice_stand_in.Participant("Flow", "here", 0, 1)
            participant.set_mesh_vertices("A", np.zeros((4, 3)))
            participant.set_mesh_vertices("F", np.zeros((1, 3)))
            participant.initialize()
            ids = np.arange(4)
            while participant.is_coupling_ongoing():
                participant.requires_writing_checkpoint()
                window = participant.exchange.window + 1
                participant.write_data("A", "Temperature", ids, np.full(4, 2.0 * window))
                participant.write_data("F", "Pressure", np.arange(1), np.full(1, 10.0 * window))
                participant.advance(0.5)
                participant.requires_reading_checkpoint()
                if participant.is_time_window_complete():
                    self.heard.append(float(participant.exchange.data["DisplacementDelta"][:, 2].mean()))

    exchange = precice_stand_in.Exchange(2, 0.5)
    precice_stand_in.EXCHANGES["here"] = exchange
    wall = Wall()
    other = threading.Thread(target=wall.run)
    other.start()
    job = amontons.Job(text=LOWER)
    configuration = {"precice-config-file": "here", "participants": {"Solid": {"interfaces": [
        {"nodes-mesh": "A", "patch": "HIGH", "read-data": ["Temperature"], "write-data": ["DisplacementDelta0"]},
        {"faces-mesh": "F", "patch": "LID", "read-data": ["Pressure"]}]}}}  # fmt: skip
    for interface in configuration["participants"]["Solid"]["interfaces"]:
        interface["write-data"] = ["DisplacementDelta"] if "nodes-mesh" in interface else []
    adapter = Adapter(job, configuration, "Solid", precice=precice_stand_in)
    assert adapter.interfaces[1].places == pytest.approx(np.array([[0.5, 0.5, 1.0]]))
    adapter.run()
    other.join()
    mean = 0.5 * 4.0  # the nodes below stay cold: the element feels the mean
    assert job.get("U", "HIGH")[:, 2] == pytest.approx(1e-3 * mean - 20.0 / 1000, rel=1e-9)
    assert wall.heard == pytest.approx([-0.009, -0.009], rel=1e-9)


@pytest.mark.parametrize(("interface", "sentence"), [
    ({"nodes-mesh": "A", "patch": "HIGH", "read-data": ["Pressure"]}, "faces-mesh"),
    ({"nodes-mesh": "A", "patch": "HIGH", "write-data": ["Velocity"]}, "cannot be written"),
    ({"nodes-mesh": "A"}, "patch"),
    ({"nodes-mesh-with-connectivity": "A", "patch": "HIGH"}, "Connectivity"),
    ({"nodes-mesh": "A", "patch": "NOWHERE"}, "NOWHERE"),
])  # fmt: skip
def test_wrong_configurations_are_reported(interface: dict, sentence: str) -> None:
    """A sentence each."""
    with amontons.Job(text=LOWER) as job, pytest.raises(amontons.UsageError, match=sentence):
        Adapter(job, {"precice-config-file": "here", "participants": {"S": {"interfaces": [interface]}}}, "S",
                precice=precice_stand_in)  # fmt: skip


def test_configuration_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """JSON; the participant must be there; without preCICE a message says so."""
    path = tmp_path / "config.json"
    path.write_text(json.dumps({"precice-config-file": "x.xml", "participants": {"S": {"interfaces": []}}}))
    configuration = read_configuration(path)
    with amontons.Job(text=LOWER) as job:
        with pytest.raises(amontons.UsageError, match="no participant T"):
            Adapter(job, configuration, "T")
        monkeypatch.setitem(sys.modules, "precice", None)
        with pytest.raises(ModuleNotFoundError):
            Adapter(job, configuration, "S")


def test_called_as_the_calculix_adapter_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """-i flap -precice-participant Solid: flap.inp and config.yml; missing parts are reported with their exit codes."""
    monkeypatch.chdir(tmp_path)
    assert main(["-i", "flap", "-precice-participant", "Solid"]) == 7
    assert "flap.inp" in capsys.readouterr().out
    (tmp_path / "flap.inp").write_text(LOWER)
    yaml = type(sys)("yaml")
    yaml.safe_load = json.loads  # JSON is YAML
    monkeypatch.setitem(sys.modules, "yaml", yaml)
    (tmp_path / "config.yml").write_text(json.dumps({"precice-config-file": "x.xml", "participants": {"Fluid": {}}}))
    assert main(["-i", "flap", "-precice-participant", "Solid"]) == 2
    assert "no participant Solid; there are Fluid" in capsys.readouterr().out
    monkeypatch.setitem(sys.modules, "precice", precice_stand_in)
    precice_stand_in.EXCHANGES["x.xml"] = precice_stand_in.Exchange(1, 1.0, is_implicit=False)
    precice_stand_in.EXCHANGES["x.xml"].barrier = threading.Barrier(1, action=precice_stand_in.EXCHANGES["x.xml"].judge)
    (tmp_path / "config.yml").write_text(json.dumps({"precice-config-file": "x.xml", "participants": {"Solid": {"interfaces": [
        {"nodes-mesh": "A", "patch": "HIGH", "read-data": ["Forces"], "write-data": ["DisplacementDeltas"]}]}}}))  # fmt: skip
    assert main(["-i", "flap", "-precice-participant", "Solid"]) == 0
    assert (tmp_path / "flap.vtkhdf").exists()
