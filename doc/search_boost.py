"""A hook of mkdocs: the search names the verification cases and the developer's pages last.

SPDX-License-Identifier: GPL-3.0-or-later
"""

LAST = {"verification": 1e-3, "developer": 1e-3}  #: factors of the rank; a word in a title counts a thousand times that in a text


def on_page_markdown(markdown, page, **_):
    """The page's rank, for the search of the theme."""
    page.meta["search"] = {"boost": LAST.get(page.file.src_uri.split("/")[0], 1.0)}
    return markdown
