"""What the numbers say, in words."""

import inspect
import platform
import re
from collections import Counter
from datetime import date

from .. import engines
from ..binding import _numba_version, can_compile
from ..scene import EXACT

NAMES = {"pymunk": "pymunk", "pybullet": "pybullet"}


def number(x, digits=3):
    """1.23e-4 as 1.23·10⁻⁴; None as a dash."""
    if x is None:
        return "–"
    if x == 0 or 1e-2 <= abs(x) < 1e4:
        return f"{x:.{digits}g}"
    mantissa, exponent = f"{x:.{digits - 1}e}".split("e")
    raised = str(int(exponent)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"{mantissa} · 10{raised}" if float(mantissa) != 1.0 else f"10{raised}"


def seconds(t):
    """A duration with its unit."""
    if t is None:
        return "–"
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if t >= size:
            return f"{t / size:.3g} {unit}"
    return f"{t / 1e-9:.3g} ns"


def percent(x):
    if x is None:
        return "–"
    return f"{100 * x:.0f} %" if x >= 0.995 else f"{100 * x:.2g} %" if x >= 1e-6 or x == 0.0 else f"{number(100 * x, 2)} %"


def factor(x):
    """A ratio; under a factor of two it is a tie."""
    if x is None:
        return "–"
    if 0.5 < x < 2.0:
        return f"a tie ({x:.2g}×)"
    return f"{x:,.0f}×" if x >= 10 else f"{x:.2g}×"


def order(curve):
    """Order of convergence as measured, and in brackets as expected."""
    if curve["expected"] == EXACT:
        return EXACT
    return f"{'–' if curve['order'] is None else format(curve['order'], '.2f')} ({curve['expected']})"


def run(plan):
    """What the report was made with."""
    live = [f"{n} {engines.installed(n)} live" if n in plan.live else f"{n} recorded" for n in engines.NAMES]
    compiled = f"numba {_numba_version()}" if can_compile() else "numba not installed: plain speed only"
    return {"of": str(plan.of), "mode": "quick" if plan.quick else "full", "engines": live, "compiler": compiled,
            "speeds": list(plan.speeds), "repeats": plan.repeats(), "machine": f"{platform.system()} {platform.machine()}, Python {platform.python_version()}",
            "date": date.today().isoformat()}


def judge(curve):
    """One word for a curve's verdict, and its kind: agrees, predicted, departs or open."""
    if curve["right"] is None:
        return ("not attempted" if "not attempted" in curve["why"] else "undecided"), "open"
    if not curve["right"]:
        return "departs", "departs"
    return ("departs as predicted", "predicted") if curve.get("reason") else ("agrees", "agrees")


def verdict(curves):
    """The same for several curves at once: the worst of them, with a count."""
    count = Counter(judge(c)[0] for c in curves)
    if not curves:
        return "not done here", "none"
    for text, kind in (("departs", "departs"), ("not attempted", "open")):
        if count[text]:
            return f"{count[text]} of {len(curves)} {text}", kind
    parts = [f"{text} ({count[word]})" for word, text in
             (("agrees", "agrees"), ("departs as predicted", "as predicted"), ("undecided", "undecided")) if count[word]]
    return ", ".join(parts), "open" if count["undecided"] == len(curves) else "agrees"


def parameters(scene):
    """[(name, value, meaning)] of the first case; the meaning is the comment beside the field."""
    p = next(iter(scene.CASES.values()))
    meanings = dict(re.findall(r"^    (\w+): [^#\n]*#\s*(.+)$", inspect.getsource(type(p)), flags=re.M))
    return [(name, value, meanings.get(name, "")) for name, value in p._asdict().items() if isinstance(value, (int, float, str))]


def row(result):
    """A line of the front page."""
    case = next(iter(result["cases"].values()))
    every = [c for one in result["cases"].values() for c in one["ours"]]
    witnesses = {name: [c for one in result["cases"].values() for c in one["engines"] if c["label"].split(",")[0] == name] for name in NAMES}
    best = max((c for c in case["ours"] if c["right"] and not c["reason"] and (c["order"] is not None or c["expected"] == EXACT)),
               key=lambda c: (c["expected"] == EXACT, c["order"] or 0.0), default=None)
    own_laws = {c["label"] for c in case["engines"] if c.get("reason")}
    advantages = {}
    for a in result["times"]["advantage"]:                               # to be as wrong as another law is no race
        name = a["engine"].split(",")[0]
        if a["engine"] not in own_laws and (name not in advantages or a["error"] < advantages[name]["error"]):
            advantages[name] = a
    return {"result": result, "ours": verdict(every), "engines": {n: (verdict(c), c[0]["source"] if c else "") for n, c in witnesses.items()},
            "best": best, "advantages": advantages, "left_out": result["times"]["left_out"]}


def findings(result):
    """Sentences, the most important first."""
    return [*_ours(result), *(f"{sentence}." for sentence in result["without"]), *_witnesses(result), *_times(result), *_left_out(result), *_parity(result)]


def _ours(result):
    every = [(n, c) for n, one in result["cases"].items() for c in one["ours"]]
    wrong = [(n, c) for n, c in every if c["right"] is False]
    for n, c in wrong:
        yield f"{c['label']} ({n}) {c['why']}."
    waiting = {}
    for _, c in every:
        if c["right"] is None:
            waiting.setdefault(c["why"], {})[c["label"]] = None
    for why, labels in waiting.items():
        yield f"{', '.join(labels)}: {why}."
    shown = [c for c in next(iter(result["cases"].values()))["ours"] if c["order"] is not None and c["right"]]
    if shown:
        yield "Measured orders of convergence: " + ", ".join(f"{c['label']} {c['order']:.2f} ({c['expected']})" for c in shown) + "; the expected order is in brackets."
    for c in next(iter(result["cases"].values()))["ours"]:
        if c["right"] and c["reason"]:
            yield f"{c['label']} converges to another law because {c['reason']}: {percent(c['departs'])} away from the truth."
    exact = [c["label"] for c in next(iter(result["cases"].values()))["ours"] if c["expected"] == "exact" and c["right"]]
    if exact and result["still"] != "":
        yield f"Exact up to round-off at every step, as derived: {', '.join(exact)}."


def _witnesses(result):
    """What engines do: in the first case of a motion; of what stands still, in every case where they depart."""
    if result["still"] is None:
        yield from _engines(next(iter(result["cases"].values())))
        return
    for name, case in result["cases"].items():
        for c in case["engines"]:
            if c.get("reason") and c["right"]:
                yield (f"{name[0].upper()}{name[1:]}: {c['label']} is {percent(c['rows'][-1]['error'])} off because {c['reason']}; "
                       f"that rule alone gives {percent(c['departs'])}.")
            elif c["right"] is False:
                yield f"{name[0].upper()}{name[1:]}: {c['label']} {c['why']}, and nothing that the scene says predicts it."


def _engines(case):
    for c in case["engines"]:
        clear = [r for r in c["rows"] if r["error"] is not None]
        if not clear:
            yield f"{c['label']}: {c['why']}."
        elif c["right"] is False:
            yield f"{c['label']} {c['why']}, and nothing that the scene says predicts it."
        elif c.get("reason"):
            yield (f"{c['label']} stays {percent(clear[-1]['error'])} away from the truth because {c['reason']}: that law alone predicts "
                   f"{percent(c['departs'])}, and the engine converges to it" + (f" with order {c['order']:.2f}." if c["order"] else "."))
        else:
            shown = f", with order {c['order']:.2f} where {c['expected']} is expected" if c["order"] is not None and c["expected"] else ""
            yield f"{c['label']} agrees with the truth to {percent(clear[-1]['error'])} at its finest step{shown}."


def _times(result):
    for a in result["times"]["advantage"]:
        if a["ratio"]:
            yield (f"The smallest error that {a['engine']} was timed at is {percent(a['error'])}, in {seconds(a['seconds'])}; ours ({a['method']}, {a['speed']}) "
                   f"gets there in {seconds(a['ours'])}: {factor(a['ratio'])}{' the speed' if not 0.5 < a['ratio'] < 2 else ''}.")
        else:
            yield f"None of those runs of ours that were timed reaches the {percent(a['error'])} of {a['engine']}, {seconds(a['seconds'])}."


def _left_out(result):
    for row in result["times"]["left_out"]:
        if row["saves"] is not None:
            same = "the motion is the same" if row["same"] else "but the motion changes: look into it"
            yield f"Putting in {row['what']} makes a step {row['saves']:.2f} times as long; {same}."


def _parity(result):
    if result["parity"] is not None:
        yield ("Where there are both, plain and compiled runs agree to the last bit." if result["parity"] == 0.0 else
               f"Where there are both, plain and compiled runs differ by at most {number(result['parity'])}, relative.")
