"""The documentation site: it builds without a warning, and every link in it leads somewhere.

It needs what `make test` and `make doc` install into .venv-doc and .venv-api (AMONTONS_MKDOCS and AMONTONS_FORD name others); else it is skipped.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path
from urllib.parse import unquote

import pytest

from verify.cases.output.test_report import BROWSER, open_in_browser
from verify.conftest import ROOT, Run
from verify.tools.card_reference import page_of
from verify.tools import site_weight
from verify.tools.module_table import page as modules_page

MKDOCS = Path(os.environ.get("AMONTONS_MKDOCS", ROOT / ".venv-doc" / "bin" / "mkdocs"))
FORD = Path(os.environ.get("AMONTONS_FORD", ROOT / ".venv-api" / "bin" / "ford"))
LINK = re.compile(r"""(?:href|src)=(["'])(.*?)\1""")
MAX_BYTES = 30 * 2**20  #: of the whole site on a disk with blocks of 4 kB, as `du -m` counts
WRITTEN_LATER = "/api/index.html"  #: by FORD, which `make doc` runs after mkdocs


@pytest.fixture(scope="module")
def site(run: Run, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site, built from a copy of doc/ with the card reference."""
    if not MKDOCS.exists():
        pytest.skip("mkdocs is not installed (make test does it)")
    folder = tmp_path_factory.mktemp("site")
    shutil.copytree(ROOT / "doc", folder / "doc")
    shutil.copy(ROOT / "mkdocs.yml", folder)
    (folder / "doc" / "manual" / "cards.md").write_text(page_of(run(["--cards"]).stdout))
    (folder / "doc" / "developer" / "modules.md").write_text(modules_page())
    done = subprocess.run([str(MKDOCS), "build", "--strict", "-d", str(folder / "out")], cwd=folder, capture_output=True, text=True,
                          env=os.environ | {"NO_MKDOCS_2_WARNING": "1"}, check=False)  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    assert "WARNING" not in done.stderr
    return folder / "out"


def broken_links(site: Path, below: str) -> list[str]:
    """Of the pages in a folder of the site: pages, pictures, styles, scripts and anchors that are not there."""
    pages = {page: page.read_text() for page in site.rglob("*.html")}
    anchors = {page: set(re.findall(r'\bid="([^"]+)"', text)) for page, text in pages.items()}
    broken = []
    for page, text in pages.items():
        if page.name == "404.html" or not page.is_relative_to(site / below):
            continue
        for link in {link for _, link in LINK.findall(text)}:
            if re.match(r"[a-z]+:", link) or not link:
                continue
            path, _, anchor = link.partition("#")
            target = (page.parent / unquote(path)).resolve() if path else page
            target = target / "index.html" if target.is_dir() else target
            if str(target).endswith(WRITTEN_LATER) and not below:
                continue
            if not target.exists() or (anchor and target in anchors and unquote(anchor) not in anchors[target]):
                broken.append(f"{page.relative_to(site)}: {link}")
    return broken


def fetched(site: Path) -> set[str]:
    """What the pages load from elsewhere."""
    loads = (re.findall(r'<(?:script|img|link)[^>]*(?:src|href)="(https?://[^"]+)"', page.read_text()) for page in site.rglob("*.html"))
    return {url for page in loads for url in page if "canonical" not in url}


def test_pages(site: Path) -> None:
    """Every link leads somewhere; fonts and scripts come with the site."""
    assert broken_links(site, "") == []
    assert fetched(site) == set()


def test_dark_mode_and_link_to_the_source(site: Path) -> None:
    """Each page can be turned dark, and is where the system is dark; the pages of the source are linked."""
    for name in ("index.html", "manual/contact.html"):
        text = (site / name).read_text()
        assert re.search(r'data-md-color-media="\(prefers-color-scheme: dark\)"[^>]*data-md-color-scheme="slate"', text), name
    assert any('api/index.html"' in page.read_text() for page in site.glob("developer/*.html"))


@pytest.mark.slow
def test_pages_of_the_source(site: Path) -> None:
    """The same for the pages by FORD, which lie within the site; and they have the docstrings from their first word on."""
    if not FORD.exists():
        pytest.skip("FORD is not installed (make test does it)")
    command = [MKDOCS.parent / "python", ROOT / "verify" / "tools" / "api_pages.py", FORD, site / "api"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert broken_links(site, "api") == []
    assert fetched(site / "api") == set()
    text = (site / "manual" / "first_job.html").read_text()
    code = re.findall(r"<pre\b.*?</pre>", text, re.DOTALL)
    site_weight.lighten(site)
    assert broken_links(site, "") == []
    assert re.findall(r"<pre\b.*?</pre>", (site / "manual" / "first_job.html").read_text(), re.DOTALL) == code != []
    assert sum(4096 * -(-path.stat().st_size // 4096) for path in site.rglob("*") if path.is_file()) < MAX_BYTES
    first = re.match(r"!> ([\w :]+)", (ROOT / "src" / "contact_laws" / "friction_slip_scenarios.f90").read_text())
    assert first and f"<p>{first[1]}" in (site / "api" / "module" / "amontons_friction_slip_scenarios.html").read_text()
    assert 'src/friction_slip_scenarios.f90' in (site / "api" / "module" / "amontons_friction_slip_scenarios.html").read_text()


@pytest.mark.skipif(BROWSER is None, reason="Chromium is not installed (.ci/deps browser)")
@pytest.mark.slow
def test_search(site: Path, tmp_path: Path) -> None:
    """Pages that are opened as files can be searched, and no script complains."""
    document, log = open_in_browser(f"{(site / 'index.html').as_uri()}?q=stick+slope", tmp_path)
    links = re.findall(r'<a [^>]*class="md-search-result__link"[^>]*>', document)
    assert "manual/" in links[0], links
    assert any("manual/cards.html" in link for link in links), links
    assert [line for line in log.splitlines() if "CONSOLE" in line] == []
