"""Texts and numbers in pages, CSV and JSON, safe to show for every input of students."""

import re

from markupsafe import Markup

from . import marking

FORMULA = re.compile(r"""(^|[;|,\t])(?=[\s"']*[=+\-@＝＋－＠])""")     # at the start or after a separator


def clean(value):
    """Spell out control, format and undecodable characters of a text and limit its length; return others unchanged."""
    return marking.readable(value) if isinstance(value, str) and not isinstance(value, Markup) else value


def line(text):
    """Clean a text as `clean` does, and put it on one line."""
    return clean(text).replace("\n", "\\x0a")


def number(x):
    """Format points with at most six digits: 3, 2.5, 0.333333."""
    return f"{x:.6g}"


def many(n, what):
    return f"{n} {what}{'' if n == 1 else 's'}"


def cell(text):
    """Return a text that no spreadsheet runs as a formula.

    A spreadsheet may split cells at other separators than ours, trim blanks and quotes, and accept the wide signs
    of East Asian keyboards.  Each part that begins as a formula gets an apostrophe.
    """
    return FORMULA.sub(r"\1'", line(text))
