"""Random faults: in a given function, one token becomes another.

Chance chooses the token, so these faults show which given functions the report does not look at.  Some of them change
no result: a search ends later, or two sizes are equal.  So read each one that is missed.
"""

import ast
import io
import random
import tokenize

from validate.run import coverage
from validate.subject import modules

from . import Fault, file_of, planted

PAIRS = (("+", "-"), ("*", "/"), ("<", ">"), ("==", "!="), ("+=", "-="), ("*=", "/="), ("and", "or"), ("True", "False"),
         ("min", "max"), ("minimum", "maximum"), ("sin", "cos"))
EXCHANGED = {**dict(PAIRS), **{b: a for a, b in PAIRS}, "<=": ">", ">=": "<"}
LARGER = 1.1                 # a number of that times its size
PLACES = {"0": "1", "1": "0", "2": "1"}                  # of an array: another one


def drawn(count, seed):
    """Return so many Faults, each in another given function that a scene or a stability case executes."""
    chance = random.Random(seed)
    functions = sorted(place for place in coverage.places() if place[0] not in modules.lesson_names())
    chance.shuffle(functions)
    found = []
    for module, function in functions:
        if len(found) < count and (faults := faults_in(module, function)):
            found.append(chance.choice(faults))
    return found


def faults_in(module, function):
    """Return a list of all Faults that exchange one token of a function."""
    text = (modules.SOLUTIONS / file_of(module)).read_text(encoding="utf-8")
    node = next((n for n in ast.parse(text).body if isinstance(n, ast.FunctionDef) and n.name == function), None)
    if node is None:
        return []
    lines, calculating = text.splitlines(), lines_that_calculate(node)
    tokens = list(tokenize.generate_tokens(io.StringIO(text).readline))
    found = []
    for before, token, after in zip(tokens, tokens[1:], tokens[2:], strict=False):
        (row, begin), (_, end) = token.start, token.end
        if row in calculating and (new := another(before.string, token, after.string)):
            old = lines[row - 1]
            if old[:begin].endswith("reshape(-"):                    # −1 and −2 both mean: as many as there are
                continue
            found += planted_once(module, function, lines[row - 2], old, old[:begin] + new + old[end:])
    return found


def lines_that_calculate(node):
    """Return the numbers of the lines of a function without its docstring, and without those that only refuse."""
    refuse = set()
    for part in ast.walk(node):
        if isinstance(part, ast.Raise) or (isinstance(part, ast.If) and isinstance(part.body[0], ast.Raise)):
            last = part.body[-1] if isinstance(part, ast.If) else part
            refuse |= set(range(part.lineno, last.end_lineno + 1))
    body = node.body[1 if ast.get_docstring(node) else 0:]
    return set(range(body[0].lineno, node.end_lineno + 1)) - refuse if body else set()


def another(before, token, after):
    """Return the text that replaces a token between these two texts; None if it stays."""
    text = token.string
    if token.type != tokenize.NUMBER:
        return EXCHANGED.get(text) if token.type in (tokenize.NAME, tokenize.OP) else None
    if not text.isdigit():
        return repr(LARGER * float(text) or 0.1)
    if before == "[" and after in "],":
        return PLACES.get(text)
    return str(int(text) + 1) if before in ("+", "-", "*", "/") else None


def planted_once(module, function, above, old, new):
    """Return [Fault] of a changed line, with the line above if it stands there twice; [] where it cannot be planted."""
    for first in ("", f"{above}\n"):
        fault = Fault(module, function, first + old, first + new, f"{old.strip()}  →  {new.strip()}")
        try:
            compile(planted(fault), module, "exec")
        except (ValueError, SyntaxError):
            continue
        return [fault]
    return []
