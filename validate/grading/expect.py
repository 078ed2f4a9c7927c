"""The few ways in which a grading test compares.  A failure carries quantity, expected, got and tolerance as data.

What a student reads is written here, too: four digits, more only where expected and got would look alike.
"""

import re
from math import floor, log10

import numpy as np

DIGITS, MOST_DIGITS = 4, 7   # of a number, where four tell it apart, and at most
FEW = 4                      # up to this many numbers are all shown; of more only the first that differs
MOST_NUMBERS = (12, 6, 3)    # of one array among the inputs; the later ones where the text is still too long
LONGEST = 300                # of a text [characters]
MARGIN = re.compile(r"(?<=\[) | (?=[\],])")                            # as NumPy prints arrays: [ 1.   -0.25]
BETWEEN = re.compile(r"(?:(?<=[\d.\]])|(?<=nan|inf)) (?=-?(?:[\d\[]|nan|inf))")
FLOAT = re.compile(r"(?<![\w.])-?\d+\.\d*(?:e[-+]?\d+)?")
NOTHING = "None: does every path through your function end with a return?"
AT_A_BOUND = 1e-13           # relative difference from a bound that is round-off
ROUNDING, NEARLY = 1e-15, 1e-6          # relative differences: round-off, and an error that a test looks for


class NotYet(AssertionError):
    """An answer that is not right yet.

    quantity and tolerance may be shown to anyone.  given (the inputs), expected and got may not when the inputs are
    secret; then error, in few words, stands in for them.
    compared: (got, expected) as numbers, where there are any; a notebook draws them.
    """

    def __init__(self, quantity, expected, got, tolerance, error="", given="", compared=(None, None)):
        self.quantity, self.tolerance, self.error, self.compared = quantity, tolerance, error, compared
        self.expected, self.got, self.given = tidy(expected, MOST_DIGITS), tidy(got, MOST_DIGITS), tidy(given)
        words = {"expected": self.expected, "got": self.got, "tolerance": tolerance}
        told = ", ".join(f"{name} {text}" for name, text in words.items() if text)
        super().__init__(f"{quantity}{f' ({self.given})' if self.given else ''}: {told}")


# ---------------------------------------------------------------------------------------------- comparing

def numbers(quantity, got, shape, given="", expected=None):
    """Return got as a float array; raise NotYet if it has another shape, or holds NaN or infinity.

    expected: the array of numbers that were expected, if it is known.
    """
    if got is None:
        raise NotYet(quantity, of_shape(shape), NOTHING, "", "None", given)
    try:
        array = np.asarray(got, dtype=float)
    except (TypeError, ValueError):
        raise NotYet(quantity, of_shape(shape), kind(got), "", kind(got), given) from None
    if array.shape != shape:
        raise NotYet(quantity, of_shape(shape), of_shape(array.shape), "", f"shape {array.shape}", given)
    if not np.all(np.isfinite(array)):
        first = first_of(~np.isfinite(array))
        wanted = "finite numbers" if expected is None else f"{number(expected[first])}{place(first)}"
        raise NotYet(quantity, wanted, f"{number(array[first])}{place(first)}", "", "not finite", given)
    return array


def close(quantity, got, expected, tolerance, given=""):
    """Require got to equal expected, entry by entry, within an absolute tolerance.  given: the inputs, in words."""
    expected = np.asarray(expected, dtype=float)
    array = numbers(quantity, got, expected.shape, given, expected)
    off = np.abs(array - expected)
    if not np.all(off <= tolerance):
        allowed = f"{tolerance:.1e}" if tolerance else "none: exactly this"
        texts = compared(expected, array, ~(off <= tolerance))
        error = how_far(np.max(off), np.max(np.abs(expected)))
        raise NotYet(quantity, *texts, allowed, error, given, (array, expected))


def between(quantity, got, low, high, given=""):
    """Require low ≤ got ≤ high, for one number; who aims at a bound may miss it by round-off."""
    value = float(numbers(quantity, got, (), given))
    if not low - AT_A_BOUND * abs(low) <= value <= high + AT_A_BOUND * abs(high):
        edge, shown = apart(low if value < low else high, value)
        ends = (edge, number(high)) if value < low else (number(low), edge)
        off = how_far(max(low - value, value - high), max(abs(low), abs(high)))
        raise NotYet(quantity, " to ".join(ends), shown, "", off, given)


def truth(quantity, got, expected, given=""):
    """Require got to be True or False, as expected; 1 and 0 count as True and False."""
    if not isinstance(got, (bool, np.bool_, int, float)) or got not in (0, 1):
        raise NotYet(quantity, str(bool(expected)), NOTHING if got is None else kind(got), "", "another kind", given)
    if bool(got) != bool(expected):
        raise NotYet(quantity, str(bool(expected)), str(bool(got)), "", "the opposite", given)


def choice(quantity, got, right, letters="ABCD"):
    """Require got to be the right one of these letters; a small one counts, too.  The right one is not shown."""
    letter = got.strip().upper() if isinstance(got, str) else ""
    if len(letter) != 1 or letter not in letters:
        allowed = f"one of the letters {', '.join(letters)}, as a text"
        shown = NOTHING if got is None else f"“{got}”" if isinstance(got, str) else kind(got)
        raise NotYet(quantity, allowed, shown, "", "no letter")
    if letter != right:
        raise NotYet(quantity, "another letter", letter, "", "another letter")


def instance(quantity, got, wanted, given=""):
    """Require got to be of this class, such as a tuple."""
    if not isinstance(got, wanted):
        raise NotYet(quantity, f"a {wanted.__name__}", NOTHING if got is None else kind(got), "", "another kind", given)


def kind(value):
    """Return what kind of thing a value is, in words."""
    if isinstance(value, np.ndarray):
        return of_shape(value.shape)
    return "a number" if isinstance(value, (int, float)) else f"a {type(value).__name__}"


def raises(quantity, error, function, *arguments, naming=(), thing=""):
    """Require the call to raise an error of that class, or of one with its name.

    Compiled and sandboxed code have classes of their own.
    naming: values of which the error's sentence must name one, to 1e-6 of it.  thing: how the sentence must begin.
    """
    try:
        function(*arguments)
    except NotImplementedError:
        raise
    except Exception as e:
        if error.__name__ not in {base.__name__ for base in type(e).__mro__}:
            raise NotYet(quantity, error.__name__, f"{type(e).__name__}: {e}", "", "another error") from None
        said = [float(number) for number in re.findall(r"-?\d+\.?\d*(?:e[-+]?\d+)?|-?inf|nan", str(e))]
        if naming and not any(abs(a - b) <= 1e-6 * abs(b) for a in said for b in naming):
            quantity = f"{quantity}: the value that {error.__name__} names"
            values = " or ".join(f"{value:.{MOST_DIGITS}g}" for value in naming)
            raise NotYet(quantity, values, str(e), "", "another value") from None
        if not str(e).startswith(thing):
            quantity = f"{quantity}: the thing that {error.__name__} names"
            raise NotYet(quantity, thing, str(e), "", "another value") from None
    else:
        raise NotYet(quantity, f"{error.__name__} to be raised", "no error", "", "no error")


OFF = ("slightly off", "clearly off", "grossly off")


def how_far(off, size):
    """Return one of three words for an error: below a hundredth of the expected size, below all of it, beyond.

    If zero is expected, the size is one unit.  A number here would leak a digit of a secret input with each attempt.
    """
    if not np.isfinite(off):
        return OFF[2]
    part = off / (size or 1.0)
    return OFF[0] if part < 0.01 else OFF[1] if part < 1.0 else OFF[2]


# ---------------------------------------------------------------------------------------------- what is read

def number(x, digits=DIGITS):
    """Return a number in this many digits, or in as many as it has before its point; a whole one unchanged."""
    x = float(x)
    if not np.isfinite(x) or x == 0.0:
        return f"{abs(x) if x == 0.0 else x:g}"
    whole = floor(log10(abs(x))) + 1
    return f"{x:.{max(digits, whole if whole <= MOST_DIGITS else 0)}g}"


def apart(a, b):
    """Return two numbers in as few digits as distinguish them; if seven digits do not, return one as a difference."""
    if not np.isfinite(b - a):
        return number(a), number(b)
    for digits in range(DIGITS, MOST_DIGITS + 1):
        texts = number(a, digits), number(b, digits)
        last_place = 10.0 ** (floor(log10(max(abs(a), abs(b)))) + 1 - digits)
        if texts[0] != texts[1] and abs(b - a) >= last_place:
            return texts
    return number(a), plus(number(a), b - a)


def compared(expected, got, differs):
    """Return (expected, got) in words: a few numbers whole, of more the first that differs, and how many do."""
    first = first_of(differs)
    if expected.size > FEW:
        a, b = apart(expected[first], got[first])
        return a + place(first), f"{b}{place(first)}; {np.count_nonzero(differs)} of {expected.size} entries differ"
    entries = zip(expected.flat, got.flat, differs.flat, strict=True)
    pairs = [apart(a, b) if wrong else (number(a), number(b)) for a, b, wrong in entries]
    texts = tuple(", ".join(column) for column in zip(*pairs, strict=True))
    return texts if expected.ndim == 0 else tuple(f"({text})" for text in texts)


def of_shape(shape):
    return f"an array of shape {shape}" if shape else "a number"


def first_of(mask):
    """Return the index of the first true entry."""
    return tuple(int(i[0]) for i in np.nonzero(mask)) if mask.ndim else ()


def place(index):
    return f" at [{', '.join(map(str, index))}]" if index else ""


def plus(text, difference):
    return f"{text} {'-' if difference < 0.0 else '+'} {abs(difference):.2g}"


def tidy(text, digits=DIGITS):
    """Return a text for readers: without NumPy's words, with short numbers, and with the beginning of a long array."""
    text = " ".join(re.sub(r"\bnp\.\w+\(([^()]*)\)|\bnp\.(True|False)_", r"\1\2", str(text)).split())
    text = re.sub(r"\barray\(\[\], shape=\([^)]*\)(, dtype=\w+)?\)", "[]", text)
    text = re.sub(r"\barray\(([^()]*?)(, dtype=\w+)?\)", r"\1", text)
    text = re.sub(r"(?<=\w)=(?=[^\s=])", " = ", text)
    text = _in_brackets(text, lambda array: BETWEEN.sub(", ", MARGIN.sub("", array)))
    text = FLOAT.sub(lambda match: _shortened(float(match[0]), digits), text)
    for most in MOST_NUMBERS:
        cut = _in_brackets(text, lambda array, most=most: _beginning(array, most))
        if len(cut) <= LONGEST:
            return cut
    return cut[:LONGEST - 2].rpartition(" ")[0] + " …"


def _shortened(x, digits):
    """Return a number in this many digits; one that is nearly a short one shows the difference: 0.5 - 1e-11."""
    text = number(x, digits)
    rest, short = x - float(text), len(text.partition("e")[0].replace(".", "").strip("-0")) <= 2
    return plus(text, rest) if short and ROUNDING * abs(x) < abs(rest) < NEARLY * abs(x) else text


def _in_brackets(text, change):
    """Return the text with every outermost [array] changed."""
    parts, depth, begin = [], 0, 0
    for k, character in enumerate(text):
        depth += (character == "[") - (character == "]" and depth > 0)
        if character == "[" and depth == 1:
            parts.append(text[begin:k])
            begin = k
        elif character == "]" and depth == 0:
            parts.append(change(text[begin:k + 1]))
            begin = k + 1
    return "".join(parts) + text[begin:]


def _beginning(array, most):
    """Return an array's text; of a longer one only the first numbers, and of a matrix whole rows where one fits."""
    found = list(re.finditer(r"[^\s,\[\]]+", array))
    if len(found) <= most:
        return array
    end = found[most - 1].end()
    end += len(re.match(r"\]*", array[end:])[0])
    kept = array[:array.rfind("]", 0, end) + 1] or array[:end]
    return f"{kept}, …{']' * (kept.count('[') - kept.count(']'))}"
