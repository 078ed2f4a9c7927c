"""Numbers of a report as text."""

from math import floor, log10


def rounded(x, digits=2):
    """Return a number with so many digits that count, written out: 270, 3.8, 0.042."""
    x = float(f"{x:.{digits}g}")
    decimals = max(0, digits - 1 - floor(log10(abs(x)))) if x else 0
    return f"{x:,.{decimals}f}"


def number(x, digits=3):
    """1.23e-4 as 1.23 · 10⁻⁴; None as a dash."""
    if x is None:
        return "–"
    if x < 0:
        return f"−{number(-x, digits)}"
    x = abs(x)                                                       # of −0
    if x == 0 or 1e-2 <= x < 1e4:
        short = f"{x:.{digits}g}"
        return short if "e" not in short else rounded(x, digits).replace(",", "")
    mantissa, exponent = f"{x:.{digits - 1}e}".split("e")
    raised = str(int(exponent)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"{mantissa} · 10{raised}" if float(mantissa) != 1.0 else f"10{raised}"


def known(x, tolerance):
    """Return a number with as many decimals as its tolerance leaves: 2.82843 where the tolerance is 0.00003."""
    if x is not None and not tolerance and x == round(x) and abs(x) < 1e9:
        return f"{x:,.0f}"                                           # a count
    if x is None or not tolerance or x == 0:
        return number(x, 7)
    decimals = max(0, -floor(log10(tolerance)))
    return f"{x:.{decimals}f}" if abs(x) < 1e5 and decimals <= 15 and abs(x) > tolerance else number(x, 2)


def seconds(t):
    """Return a duration with its unit, to two digits: a machine repeats no time more exactly."""
    if t is None:
        return "–"
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if float(f"{t:.2g}") >= size:
            return f"{rounded(t / size)} {unit}"
    return f"{rounded(t / 1e-9)} ns"


def percent(x):
    if x is None:
        return "–"
    if x >= 0.995:
        return f"{100 * x:.0f} %"
    return f"{100 * x:.2g} %" if x >= 1e-6 or x == 0.0 else f"{number(100 * x, 2)} %"


def percents(low, high):
    """Return a range of relative errors."""
    return percent(high) if percent(low) == percent(high) else f"{percent(low).removesuffix(' %')} to {percent(high)}"


def factor(x):
    """Return a ratio of times."""
    return "–" if x is None else f"{rounded(x)}×"


def engine_name(product, variant):
    """Return the name of an engine with its settings inside a sentence."""
    return f"{product} ({variant})" if variant else product
