"""What all tests share: where the programs are, and how a job is run.

`make test` says where things are (AMONTONS_BIN, AMONTONS_LIB, AMONTONS_UNITS); by hand, pytest finds the release build.
"""

import os
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from verify.cases.proof import MAX_OVER_ALL, Case, write_index

#: Iteration counts are references, and where rounding decides a path they follow the BLAS kernel, which OpenBLAS chooses by the processor.
#: So the verification runs with one kernel wherever the processor has AVX2. OPENBLAS_CORETYPE names another.
if "avx2" in (Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").exists() else ""):
    os.environ.setdefault("OPENBLAS_CORETYPE", "Haswell")

ROOT = Path(__file__).resolve().parent.parent
TIME_LIMIT = 900  # [s] of one job
PAGES = os.environ.get("AMONTONS_PAGES")  # folder of the pages that `make verify` requests

#: Modules whose fixture runs each case once, when its first test needs it.
RUN_BY_CASE = {"test_contact_cases"}

Run = Callable[..., subprocess.CompletedProcess[str]]


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """What runs another program beside ours is slow; tests that share a job stay on one worker, which runs it once (--dist loadgroup)."""
    for item in items:
        if "peers" in item.path.parts:
            item.add_marker(pytest.mark.slow)
        if isinstance(item, pytest.Function) and (name := shared_work(item)):
            item.add_marker(pytest.mark.xdist_group(name))
            if getattr(config.option, "loadgroup", False):
                name_group(item, name)


def name_group(item: pytest.Item, name: str) -> None:
    """The group at the end of the name by which pytest-xdist deals out tests: its 3.8 writes it where pytest 9.2 does not read it any more,
    so that each worker ran what tests share again."""
    if hasattr(item, "_id"):
        setattr(item, "_id", type(item._id).parse(f"{item.nodeid}@{name}"))  # noqa: B010


def shared_work(item: pytest.Function) -> str:
    """What a test shares with others: the case of a function that runs each case once, or its module's fixture; '': nothing."""
    fixtures = getattr(item, "_fixtureinfo").name2fixturedefs  # noqa: B009
    if not any(definitions[-1].scope == "module" for definitions in fixtures.values()):
        return ""
    case = item.callspec.params.get("case", "") if hasattr(item, "callspec") else ""
    return f"{item.path.stem}-{case}" if item.path.stem in RUN_BY_CASE else item.path.stem


@pytest.fixture(scope="session")
def root() -> Path:
    """The top of the repository."""
    return ROOT


@pytest.fixture(scope="session")
def program() -> Path:
    """The program amontons."""
    path = ROOT / os.environ.get("AMONTONS_BIN", "bin") / "amontons"
    if not path.exists():
        pytest.fail(f"{path} is not there; `make` builds it.")
    return path


@pytest.fixture(scope="session")
def library() -> Path:
    """The shared library."""
    path = ROOT / os.environ.get("AMONTONS_LIB", "lib") / "libamontons.so"
    if not path.exists():
        pytest.fail(f"{path} is not there; `make` builds it.")
    return path


@pytest.fixture(scope="session")
def run(program: Path) -> Run:
    """Runs amontons with the words of a command line; output and errors come back as text."""

    def run_program(words: Sequence[str | Path], cwd: Path | None = None, threads: int = 1) -> subprocess.CompletedProcess[str]:
        environment = os.environ | {"OMP_NUM_THREADS": str(threads)}
        command = [str(program), *map(str, words)]
        return subprocess.run(command, cwd=cwd, env=environment, capture_output=True, text=True, timeout=TIME_LIMIT)

    return run_program


@pytest.fixture
def run_deck(run: Run, tmp_path: Path) -> Run:
    """Runs the text of a deck as tmp_path/job.inp; the results are beside it."""

    def run_text(deck: str, *options: str, threads: int = 1) -> subprocess.CompletedProcess[str]:
        (tmp_path / "job.inp").write_text(deck)
        return run([*options, "job"], cwd=tmp_path, threads=threads)

    return run_text


@pytest.fixture
def proof(run: Run, tmp_path: Path, request: pytest.FixtureRequest) -> Callable[..., Case]:
    """Makes a verification case: proof(name, title=..., model=..., formula=..., source=..., proves=...)."""
    pages = Path(PAGES).resolve() if PAGES else None
    if pages:
        pages.mkdir(parents=True, exist_ok=True)

    def make(name: str, **words: str) -> Case:
        test = f"{request.node.path.relative_to(ROOT)}::{request.node.name}"
        values = tuple(request.node.callspec.indices.values()) if hasattr(request.node, "callspec") else ()
        return Case(name, runner=run, work=tmp_path, pages=pages, file=request.module.__name__.rpartition(".")[2], test=test, values=values, **words)

    return make


def pytest_sessionfinish(session: pytest.Session) -> None:
    """The index of the pages, once, when all workers are done; too many iterations over all cases fail the session."""
    if PAGES and not hasattr(session.config, "workerinput"):
        mean = write_index(Path(PAGES).resolve())
        if mean > MAX_OVER_ALL:
            print(f"\n{mean:.2f} Newton iterations per increment over all cases; at most {MAX_OVER_ALL:g} are allowed.")
            session.exitstatus = pytest.ExitCode.TESTS_FAILED
