"""What the numbers say, in words."""

from collections import Counter

from ..results import Verdict, is_right
from ..scene import EXACT, PRODUCTS

KINDS = {Verdict.AGREES: "agrees", Verdict.FOLLOWS_OWN_LAW: "predicted", Verdict.DEPARTS: "departs",
         Verdict.UNDECIDED: "open", Verdict.NOT_ATTEMPTED: "open"}             # classes of the style sheet
TEXTS = {Verdict.FOLLOWS_OWN_LAW: "departs as predicted"}                      # the others are called by their own word


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
    if x >= 0.995:
        return f"{100 * x:.0f} %"
    return f"{100 * x:.2g} %" if x >= 1e-6 or x == 0.0 else f"{number(100 * x, 2)} %"


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


def judge(curve):
    """(text, kind) of a curve's verdict; the kind is a class of the style sheet."""
    verdict = Verdict(curve["verdict"])
    return TEXTS.get(verdict, verdict.value), KINDS[verdict]


def verdict(curves):
    """The same for several curves at once: the worst of them, with a count."""
    count = Counter(Verdict(c["verdict"]) for c in curves)
    if not curves:
        return "not done here", "none"
    for one in (Verdict.DEPARTS, Verdict.NOT_ATTEMPTED):
        if count[one]:
            return f"{count[one]} of {len(curves)} {one.value}", KINDS[one]
    shown = Verdict.AGREES, Verdict.FOLLOWS_OWN_LAW, Verdict.UNDECIDED
    parts = [f"{one.value} ({count[one]})" for one in shown if count[one]]
    return ", ".join(parts), "open" if count[Verdict.UNDECIDED] == len(curves) else "agrees"


def row(result):
    """One scene on the front page."""
    first = next(iter(result["cases"].values()))
    cases = result["cases"].values()
    ours = [c for one in cases for c in one["ours"]]
    engines = {name: [c for one in cases for c in one["engines"] if c["product"] == name] for name in PRODUCTS}
    return {
        "result": result,
        "ours": verdict(ours),
        "engines": {name: (verdict(curves), curves[0]["source"] if curves else "") for name, curves in engines.items()},
        "best": best_order(first["ours"]),
        "advantages": best_advantages(first["engines"], result["times"]["advantage"]),
        "ablations": result["times"]["ablations"],
    }


def left_out(results):
    """Scenes of the lessons before the simulator, and what the whole loop costs there: [{scene, title, lesson, …}]."""
    return [{"scene": r["scene"], "title": r["title"], "lesson": r["lesson"], "uses": r["uses"],
             **(r["times"].get("left_out") or {"ratio": None, "note": "not measured"})}
            for r in results if r["lesson"] not in ("simulator", "kinematics")]


def best_order(curves):
    """The curve of ours that agrees and shows the highest order."""
    agreeing = [c for c in curves if Verdict(c["verdict"]) is Verdict.AGREES]
    known = [c for c in agreeing if c["order"] is not None or c["expected"] == EXACT]
    return max(known, key=lambda c: (c["expected"] == EXACT, c["order"] or 0.0), default=None)


def best_advantages(curves, advantages):
    """{product: the race to its smallest error}.  To be as wrong as another law is no race."""
    own_laws = {c["label"] for c in curves if c["departure_reason"]}
    best = {}
    for a in sorted(advantages, key=lambda a: -a["error"]):
        if a["engine"] not in own_laws:
            best[a["product"]] = a
    return best


def findings(result):
    """Sentences, the most important first, and what was left out at the end."""
    notes = (f"{sentence}." for sentence in result["notes"])
    return [*_ours(result), *_engines_of(result), *_times(result), *_ablations(result), *_parity(result), *notes]


def _ours(result):
    every = [(n, c) for n, one in result["cases"].items() for c in one["ours"]]
    wrong = [(n, c) for n, c in every if is_right(c) is False]
    for n, c in wrong:
        yield f"{c['label']} ({n}) {c['message']}."
    waiting = {}
    for _, c in every:
        if is_right(c) is None:
            waiting.setdefault(c["message"], {})[c["label"]] = None
    for why, labels in waiting.items():
        yield f"{', '.join(labels)}: {why}."
    shown = [c for c in next(iter(result["cases"].values()))["ours"] if c["order"] is not None and is_right(c)]
    if shown:
        orders = ", ".join(f"{c['label']} {c['order']:.2f} ({c['expected']})" for c in shown)
        yield f"Measured orders of convergence, with the expected order in brackets: {orders}."
    for c in next(iter(result["cases"].values()))["ours"]:
        if Verdict(c["verdict"]) is Verdict.FOLLOWS_OWN_LAW:
            yield (f"{c['label']} converges to another law because {c['departure_reason']}. "
                   f"That law is {percent(c['departure'])} away from the truth.")
    exact = [c["label"] for c in next(iter(result["cases"].values()))["ours"] if c["expected"] == EXACT and is_right(c)]
    if exact and result["refinement"]:
        yield f"Exact up to round-off at every step, as derived: {', '.join(exact)}."


def _engines_of(result):
    """What the engines do: for a motion in its first case, else in every case in which they depart."""
    if result["moves"]:
        yield from _engines(next(iter(result["cases"].values())))
        return
    for name, case in result["cases"].items():
        for c in case["engines"]:
            if Verdict(c["verdict"]) is Verdict.FOLLOWS_OWN_LAW:
                yield (f"{name[0].upper()}{name[1:]}: {c['label']} is {percent(c['rows'][-1]['error'])} off because "
                       f"{c['departure_reason']}. That rule alone gives {percent(c['departure'])}.")
            elif is_right(c) is False:
                yield f"{name[0].upper()}{name[1:]}: {c['label']} {c['message']}; the scene does not predict it."


def _engines(case):
    for c in case["engines"]:
        clear = [r for r in c["rows"] if r["error"] is not None]
        if not clear:
            yield f"{c['label']}: {c['message']}."
        elif is_right(c) is False:
            yield f"{c['label']} {c['message']}; the scene does not predict it."
        elif c["departure_reason"]:
            order_shown = f" with order {c['order']:.2f}" if c["order"] else ""
            yield (f"{c['label']} stays {percent(clear[-1]['error'])} away from the truth because "
                   f"{c['departure_reason']}. "
                   f"That law alone predicts {percent(c['departure'])}, and the engine converges to it{order_shown}.")
        else:
            known = c["order"] is not None and c["expected"]
            shown = f", with order {c['order']:.2f} where {c['expected']} is expected" if known else ""
            yield f"{c['label']} agrees with the truth to {percent(clear[-1]['error'])} at its finest step{shown}."


def _times(result):
    for a in result["times"]["advantage"]:
        if a["ratio"]:
            sooner = f", {factor(a['ratio'])}" if 0.5 < a["ratio"] < 2 else f": {factor(a['ratio'])} the speed"
            yield (f"{a['engine']} reaches an error of {percent(a['error'])} in {seconds(a['seconds'])}. "
                   f"Our {a['method']} ({a['speed']}) reaches it in {seconds(a['ours'])}{sooner}.")
        else:
            yield (f"{a['engine']} reaches an error of {percent(a['error'])} in {seconds(a['seconds'])}. "
                   "None of our timed runs reaches it.")


def _ablations(result):
    for row in result["times"]["ablations"]:
        if row["cost"] is not None:
            same = "the motion is the same" if row["same"] else "but the motion changes: look into it"
            yield f"Putting in {row['what']} makes a step {row['cost']:.2f} times as long; {same}."


def _parity(result):
    if result["parity"] is not None:
        yield ("Plain and compiled runs agree to the last bit." if result["parity"] == 0.0 else
               f"Plain and compiled runs differ by at most {number(result['parity'])}, relative.")
