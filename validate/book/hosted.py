"""Buttons that open a lesson without an installation: in the reader's browser, on Binder, on Colab.

Binder and Colab fetch the repository, so their buttons need its public address: `repository-code` in CITATION.cff, or
the clone's origin.  Without one, or where it is not on GitHub, the two are left out.
"""

import re

from .site import LIVE

GITHUB = re.compile(r"https://github\.com/([\w.-]+/[\w.-]+?)(?:\.git)?/?")
BRANCH = "main"
COLAB = "binder/colab.ipynb"                     # Colab opens a notebook alone, so this one fetches the others


def buttons(stem, live, address, up="../"):
    """Return the buttons of a lesson as HTML and a blank line; "" if there is none.

    up: the way from the page to the front page of the book.
    """
    links = [f'<a class="button" data-live href="{up}{live_address(stem)}">Open this lesson in your browser</a>'] * live
    links += [f'<a class="button" href="{link}">{name}</a>' for name, link in elsewhere(address, stem).items()]
    return f'<p class="buttons">{" ".join(links)}</p>\n\n' if links else ""


def live_address(stem):
    """Return the address of a notebook in the browser, from the front page of the book."""
    return f"{LIVE}/lab/index.html?path=notebooks/{stem}.ipynb"


def elsewhere(address, stem="00_start_here"):
    """Return {name of a service: address that opens a lesson there}."""
    found = GITHUB.fullmatch(address)
    if not found:
        return {}
    path = f"notebooks%2F{stem}.ipynb"
    return {"Binder": f"https://mybinder.org/v2/gh/{found[1]}/{BRANCH}?labpath={path}",
            "Colab": f"https://colab.research.google.com/github/{found[1]}/blob/{BRANCH}/{COLAB}"}


def readme(address):
    """Return the line of the README about Binder and Colab."""
    links = [f"[{name}]({link})" for name, link in elsewhere(address).items()]
    return f"Without an installation: {' or '.join(links)}." if links else WAITING


WAITING = ("Binder (`binder/`) and Colab (`binder/colab.ipynb`) are prepared. Their buttons appear in the book when it "
           "is built with the public address of the repository on GitHub: from `repository-code` in `CITATION.cff`, "
           "or from the origin of the clone.")
