"""Checks of a static site: its files request nothing from other hosts, and its links lead somewhere.

JupyterLite in its folder `live` is not ours to read: a test opens it in a browser and counts its requests.
"""

import re
from html.parser import HTMLParser
from urllib.parse import unquote, urlsplit

STYLE = re.compile(r"(?:url\(|@import) *['\"]?([^)'\";]+)")
SCRIPT = re.compile(r"""["'`]((?:https?:)?//[\w.-]+\.[^"'`\s]*)["'`]""")   # an address of a host as a string
LIVE = "live"                                                        # folder of the lessons in the browser
NAMESPACE = "http://www.w3.org/"                                     # names of languages; no page loads them


class Page(HTMLParser):
    """The addresses that a page loads, those that it links to, and its ids."""

    def __init__(self, text):
        super().__init__()
        self.loads, self.links, self.ids, self.within = [], [], set(), ""
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        has = {name: value for name, value in attributes if value}
        self.within = tag
        self.ids |= {has[name] for name in ("id", "name") if name in has}
        self.loads += [has[name] for name in ("src", "poster", "data") if name in has]
        self.loads += [part.split()[0] for part in has.get("srcset", "").split(",") if part.strip()]
        self.loads += STYLE.findall(has.get("style", ""))
        if tag == "link" and "href" in has:
            self.loads.append(has["href"])
        if tag in ("a", "area") and "href" in has:
            self.links.append(has["href"])

    def handle_data(self, data):
        if self.within == "style":
            self.loads += STYLE.findall(data)
        elif self.within == "script":
            self.loads += outside_in_script(data)

    def handle_endtag(self, tag):
        self.within = ""


def outside_in_script(text):
    """Return addresses of other hosts that a script may load."""
    return [address for address in SCRIPT.findall(text) if not address.startswith(NAMESPACE)]


def files(site):
    """Return the paths of the book's own files, sorted."""
    return [path for path in sorted(site.rglob("*")) if path.relative_to(site).parts[0] != LIVE]


def outside_requests(site):
    """Return sentences about files of a site that make a browser ask another host."""
    found = []
    for path in files(site):
        if path.suffix == ".html":
            loads = Page(path.read_text(encoding="utf-8")).loads
        elif path.suffix in (".css", ".svg"):
            loads = STYLE.findall(path.read_text(encoding="utf-8"))
        elif path.suffix == ".js":
            loads = outside_in_script(path.read_text(encoding="utf-8"))
        else:
            continue
        found += [f"{path.relative_to(site)} loads {address}" for address in loads
                  if urlsplit(address).netloc and not address.startswith(NAMESPACE)]
    return found


def wrong_links(site):
    """Return sentences about links and files of a site that lead nowhere."""
    site = site.resolve()
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in files(site) if path.suffix == ".html"}
    found = []
    for path, page in sorted(pages.items()):
        for address in dict.fromkeys(page.links + page.loads):
            parts = urlsplit(address)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not target.exists():
                found.append(f"{path.relative_to(site)} leads to {address}, which is not there")
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].ids:
                found.append(f"{path.relative_to(site)} leads to {address}, a place that is not there")
    return found


def size(folder):
    """Return size of a folder [MB]."""
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file()) / 1e6
