"""Writes the pages of the source by FORD: docstrings as they were meant, nothing fetched from the network, no link that leads nowhere.

    .venv-doc/bin/python -m verify.tools.api_pages .venv-api/bin/ford build/site/api

FORD takes `Slip: how` at the start of a docstring for a setting, and shows the marks of the lines that follow; so it gets a copy of the
source. It loads Bootstrap and MathJax from a server: Bootstrap comes from mkdocs instead, which is installed for the rest of the site, and the
docstrings hold no formula to set. Links to parts of a page that FORD does not write lead to the page. The page of a module has all of its
procedures, interfaces and types, so that pages of single ones, and the source in colours beside the source itself, are left out: links to
them lead there.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from urllib.parse import unquote

ROOT = Path(__file__).resolve().parents[2]
BOOTSTRAP = {"css": "bootstrap.min.css", "js": "bootstrap.bundle.min.js"}
FETCHED = re.compile(r'https://cdn\.jsdelivr\.net/npm/bootstrap@[^"]*/(css|js)/[^"/]*(?:\.css|\.js)')
SEALED = re.compile(r'\s(?:integrity|crossorigin)="[^"]*"')
MATHJAX = re.compile(r'<!-- MathJax -->\s*<script type="text/x-mathjax-config">.*?</script>\s*<script[^>]*MathJax\.js[^>]*></script>', re.S)
SINGLE = re.compile(r"""href=(["'])([^"'#]*?)(proc|interface|type|sourcefile)/([^"'/#]+)\.html(?:#([^"']*))?\1""")
HOME = re.compile(r"""href='\.\./((?:module|program)/[^']+)'>[^<]*</a></li>\s*<li class="breadcrumb-item active\"""")
LINK = re.compile(r"""href=(["'])([^"':#]*)#([^"']+)\1""")


def for_ford(source: str) -> str:
    """A module whose docstrings FORD reads: an empty line first, no second mark, set off lines as a block, no line about the licence."""
    lines: list[str] = []
    is_block = False
    for line in source.splitlines():
        begun = re.match(r"( *)!> ?(.*)", line)
        going_on = re.match(r"( *)!!(?: ?(.*))?$", line)
        if begun:
            lines += [f"{begun[1]}!>", f"{begun[1]}! {begun[2]}"]
        elif going_on and "SPDX-License-Identifier" not in line:
            text = going_on[2] or ""
            if text.startswith("  ") and not is_block:
                lines += [f"{going_on[1]}!", f"{going_on[1]}!     :::text"]
            is_block = text.startswith("  ")
            lines.append(f"{going_on[1]}! {'    ' * is_block}{text.strip() if not is_block else text[2:]}")
            continue
        elif not going_on:
            lines.append(line)
        is_block = False
    return "\n".join(lines) + "\n"


def without_fetching(text: str, top: str) -> str:
    """A page, `top` away from the folder of all pages, whose styles and scripts lie beside it."""
    text = MATHJAX.sub("", text)
    return SEALED.sub("", FETCHED.sub(lambda match: f"{top}{match[1]}/{BOOTSTRAP[match[1]]}", text))


def leave_out_single_pages(folder: Path) -> None:
    """Links to a procedure, an interface or a type lead to its part of the page of its module, links to a file to the file; their own pages go."""
    homes = {(kind, page.stem): HOME.search(page.read_text()) for kind in ("proc", "interface", "type") for page in (folder / kind).glob("*.html")}
    homeless = [f"{kind} {name}" for (kind, name), home in homes.items() if home is None]
    assert not homeless, f"without a module: {homeless}"

    def leading(match: re.Match[str]) -> str:
        quote, up, kind, name, part = match.groups()
        single = homes.get((kind, unquote(name)))
        place = f"src/{name}" if kind == "sourcefile" else f"{single[1]}#{part or f'{kind}-{name}'}" if single else f"{kind}/{name}.html"
        return f"href={quote}{up}{place}{quote}"

    for kind in ("proc", "interface", "type", "sourcefile"):
        shutil.rmtree(folder / kind)
    for page in folder.rglob("*.html"):
        page.write_text(SINGLE.sub(leading, page.read_text()))
    (folder / "modules.json").unlink(missing_ok=True)


def put_in_order(folder: Path, theme: Path) -> None:
    """All pages of the folder; `theme` is the folder of that theme of mkdocs which has Bootstrap."""
    for kind, name in BOOTSTRAP.items():
        (folder / kind).mkdir(exist_ok=True)
        shutil.copy(theme / kind / name, folder / kind)
    leave_out_single_pages(folder)
    texts = {page.resolve(): page.read_text() for page in folder.rglob("*.html")}
    parts = {page: set(re.findall(r'\bid="([^"]+)"', text)) for page, text in texts.items()}
    for page, text in texts.items():

        def known(match: re.Match[str], page: Path = page) -> str:
            quote, path, part = match.groups()
            target = (page.parent / unquote(path)).resolve() if path else page
            return match[0] if unquote(part) in parts.get(target, {unquote(part)}) else f"href={quote}{path or page.name}{quote}"

        top = "../" * (len(page.relative_to(folder.resolve()).parts) - 1)
        page.write_text(LINK.sub(known, without_fetching(text, top)))


def write_pages(ford: Path, folder: Path, theme: Path) -> None:
    """From src/ and doc/api.md into the folder."""
    with tempfile.TemporaryDirectory() as copy:
        for module in sorted((ROOT / "src").rglob("*.f90")):
            (Path(copy) / module.name).write_text(for_ford(module.read_text()))
        subprocess.run([ford, "-q", ROOT / "doc" / "api.md", "-d", copy, "-o", folder.resolve()], check=True)
    put_in_order(folder, theme)


if __name__ == "__main__":
    import mkdocs

    write_pages(Path(sys.argv[1]), Path(sys.argv[2]), Path(mkdocs.__file__).parent / "themes" / "mkdocs")
