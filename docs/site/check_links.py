#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""check_links.py SITE: checks that every link of a built site leads to one of its files, and every #fragment to an
id."""
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.links, self.ids = [], set()
        self.feed(path.read_text(errors="replace"))

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("id", "name") and value:
                self.ids.add(value)
            elif name in ("href", "src") and value:
                self.links.append(value)


# Doxygen links to them without writing them: the top of a frame, and a list of classes that are all private.
WRITTEN_BY_NONE = {"__top", "nested-classes"}


def main(site):
    pages = {path: Page(path) for path in site.rglob("*.html")}
    bad = count = 0
    for path, page in pages.items():
        for link in page.links:
            parts = urlsplit(link)
            # The 404 page is served at any depth, so its links are absolute.
            if parts.scheme or parts.netloc or link.startswith(("javascript:", "/")):
                continue
            count += 1
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if target.is_dir():
                target = target / "index.html"
            known = pages.get(target)
            fragment = unquote(parts.fragment)
            if not target.exists() or (fragment and known and fragment not in known.ids and fragment not in WRITTEN_BY_NONE):
                print(f"{path.relative_to(site)}: {link}: not found")
                bad += 1
    print(f"{len(pages)} pages, {count} links, {bad} of them broken")
    return 1 if bad or not count else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve()))
