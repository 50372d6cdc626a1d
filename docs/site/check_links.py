#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""check_links.py SITE: every link of every page of a built site leads to a file of it, and a #fragment to an id."""
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


def main(site):
    pages = {path: Page(path) for path in site.rglob("*.html")}
    bad = count = 0
    for path, page in pages.items():
        for link in page.links:
            parts = urlsplit(link)
            # The page for what is not found stands anywhere on a server, so its links begin at the root.
            if parts.scheme or parts.netloc or link.startswith(("javascript:", "/")):
                continue
            count += 1
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if target.is_dir():
                target = target / "index.html"
            known = pages.get(target)
            fragment = unquote(parts.fragment)
            if not target.exists() or (fragment and known and fragment not in known.ids and fragment != "__top"):
                print(f"{path.relative_to(site)}: {link}: not there")
                bad += 1
    print(f"{len(pages)} pages, {count} links, {bad} of them lead nowhere")
    return 1 if bad or not count else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve()))
