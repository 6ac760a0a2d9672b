"""Makes the documentation site light: no white space between tags, no maps of scripts, no fonts twice, no search in other languages.

    python -m verify.tools.site_weight build/site

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

KEPT = re.compile(r"(<pre\b.*?</pre>|<script\b.*?</script>|<style\b.*?</style>)", re.DOTALL)
NEEDLESS = ("*.map", "*.ttf", "lunr/**/*.js")  #: for debuggers of scripts; browsers take fonts as .woff2; languages other than English


def slim(page: str) -> str:
    """The page with one blank or line break in place of several, but in preformatted text and scripts."""
    parts = KEPT.split(page)
    return "".join(part if i % 2 else re.sub(r"\s*\n\s*", "\n", re.sub(r"[ \t]+", " ", part)) for i, part in enumerate(parts))


def lighten(site: Path) -> None:
    """All pages of a site."""
    for page in site.rglob("*.html"):
        page.write_text(slim(page.read_text()))
    for pattern in NEEDLESS:
        for file in site.rglob(pattern):
            file.unlink()


if __name__ == "__main__":
    lighten(Path(sys.argv[1]))
