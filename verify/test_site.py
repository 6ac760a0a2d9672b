"""The documentation site: it builds without a warning, and every link in it leads somewhere.

It needs what `make test` and `make doc` install into .venv-doc (AMONTONS_MKDOCS names another mkdocs); else it is skipped.

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
from card_reference import page_of, read_cards
from conftest import ROOT, Run
from rooms import page as rooms_page

MKDOCS = Path(os.environ.get("AMONTONS_MKDOCS", ROOT / ".venv-doc" / "bin" / "mkdocs"))
LINK = re.compile(r'(?:href|src)="([^"]*)"')
WRITTEN_LATER = "/api/index.html"  #: by FORD, which `make doc` runs after mkdocs


@pytest.fixture(scope="module")
def site(run: Run, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site, built from a copy of doc/ with the card reference."""
    if not MKDOCS.exists():
        pytest.skip("mkdocs is not installed (make test does it)")
    folder = tmp_path_factory.mktemp("site")
    shutil.copytree(ROOT / "doc", folder / "doc")
    shutil.copy(ROOT / "mkdocs.yml", folder)
    (folder / "doc" / "manual" / "cards.md").write_text(page_of(read_cards(run(["--cards"]).stdout)))
    (folder / "doc" / "developer" / "rooms.md").write_text(rooms_page())
    done = subprocess.run([str(MKDOCS), "build", "--strict", "-d", str(folder / "out")], cwd=folder, capture_output=True, text=True,
                          env=os.environ | {"NO_MKDOCS_2_WARNING": "1"}, check=False)  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    assert "WARNING" not in done.stderr
    return folder / "out"


def test_links(site: Path) -> None:
    """Pages, pictures and anchors."""
    pages = {page: page.read_text() for page in site.rglob("*.html")}
    anchors = {page: set(re.findall(r'\bid="([^"]+)"', text)) for page, text in pages.items()}
    broken = []
    for page, text in pages.items():
        if page.name == "404.html":
            continue
        for link in set(LINK.findall(text)):
            if re.match(r"[a-z]+:", link) or not link:
                continue
            path, _, anchor = link.partition("#")
            target = (page.parent / unquote(path)).resolve() if path else page
            target = target / "index.html" if target.is_dir() else target
            if str(target).endswith(WRITTEN_LATER):
                continue
            if not target.exists() or (anchor and target in anchors and unquote(anchor) not in anchors[target]):
                broken.append(f"{page.relative_to(site)}: {link}")
    assert broken == []


def test_nothing_is_fetched(site: Path) -> None:
    """Fonts and scripts come with the site."""
    for page in site.rglob("*.html"):
        loads = re.findall(r'<(?:script|img|link)[^>]*(?:src|href)="(https?://[^"]+)"', page.read_text())
        assert [url for url in loads if "canonical" not in url] == [], page
