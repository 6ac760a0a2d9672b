"""Makes the documentation site light: no white space between tags, no end tags and comments that HTML does without, no styles, fonts and
maps of scripts that no page loads, no search in other languages.

    python -m verify.tools.site_weight build/site

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

KEPT = re.compile(r"(<pre\b.*?</pre>|<script\b.*?</script>|<style\b.*?</style>)", re.DOTALL)
NEEDLESS = ("*.map", "*.ttf", "lunr/**/*.js")  #: for debuggers of scripts; browsers take fonts as .woff2; languages other than English
OPTIONAL = re.compile(r"<!--.*?-->|</(?:td|th|tr|thead|tbody)>", re.DOTALL)  #: comments; the HTML standard lets a table go without these end tags
STYLE = re.compile(r'href="[^"]*?([\w.-]+\.css)"')


def slim(page: str) -> str:
    """The page with one blank or line break in place of several, but in preformatted text and scripts."""
    parts = KEPT.split(page)
    return "".join(part if i % 2 else re.sub(r"\s*\n\s*", "\n", re.sub(r"[ \t]+", " ", OPTIONAL.sub("", part))) for i, part in enumerate(parts))


def lighten(site: Path) -> None:
    """All pages of a site. A link of a page to its own places needs no name of the page."""
    styles = set()
    for page in site.rglob("*.html"):
        text = slim(page.read_text())
        styles |= set(STYLE.findall(text))
        page.write_text(text.replace(f'href="../{page.parent.name}/{page.name}#', 'href="#'))
    for style in (site / "api").rglob("*.css"):
        if style.name not in styles:
            style.unlink()
    for pattern in NEEDLESS:
        for file in site.rglob(pattern):
            file.unlink()


if __name__ == "__main__":
    lighten(Path(sys.argv[1]))
