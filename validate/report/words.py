"""Sentences about the numbers of a report."""

import re
from collections import Counter
from itertools import groupby

import numpy as np
from markupsafe import Markup, escape

from ..check import Verdict, is_right
from ..engines.products import PRODUCTS
from ..measure.accuracy import relative
from ..measure.timing import SAME, interval
from ..reference import contact_laws, joint_laws
from ..scene import EXACT
from . import races
from .numbers import engine_name, number, percent, percents, rounded

KINDS = {Verdict.AGREES: "agrees", Verdict.FOLLOWS_OWN_LAW: "predicted", Verdict.DEPARTS: "departs",
         Verdict.KEEPS_LAWS: "laws", Verdict.BREAKS_AS_KNOWN: "predicted", Verdict.UNDECIDED: "open",
         Verdict.NOT_ATTEMPTED: "open", Verdict.UNFINISHED: "open",
         Verdict.REFERENCE: "reference"}                                       # classes of the style sheet
SIGNS = {"agrees": "✓", "predicted": "≈", "laws": "§", "departs": "✗", "open": "○"}  # as the style sheet draws them
LEGEND = {                   # every verdict has one name and one sign
    Verdict.AGREES: "The error stays within the limit that theory gives. We derived that limit before we measured, "
                    "except where the page calls it measured. Where theory predicts the error itself, by a formula or "
                    "by a second code with the same scheme, the run must miss the truth by just that error.",
    Verdict.FOLLOWS_OWN_LAW: "It departs from the truth and follows a law of its own instead. The scene states that "
                             "law beforehand, and the run agrees with it.",
    Verdict.KEEPS_LAWS: "No theory gives its error, which is shown. Its own steps keep the laws that hold for every "
                        "solver. Of contacts: balances of momentum, angular momentum and energy, no impulse that "
                        "pulls, Coulomb's limit, and no residual of the laws of contact above 1 % of g dt. Of joints: "
                        "they stay closed, and the energy changes by the work of loads alone, both as far as a step "
                        "of its length allows.",
    Verdict.BREAKS_AS_KNOWN: "The same laws judge it, and it breaks one or more of them, each by a rule that the scene "
                             "names beforehand, and by no more than that rule can where it gives a bound.",
    Verdict.DEPARTS: "It departs from the truth, and nothing predicted that. Something is wrong here.",
    Verdict.UNDECIDED: "No theory says how far it may be off, or every step was too coarse, or the engine is missing "
                       "here. The error is shown and not judged.",
    Verdict.NOT_ATTEMPTED: "The exercise behind this method has no answer yet.",
    Verdict.UNFINISHED: "The method does not come to its end in this case, as the scene says and a test confirms.",
    Verdict.REFERENCE: "The truth of this case is a run of the engine itself. It is not judged and counts nowhere.",
}
ARROWS = {"ω": "angular velocity ω", "L": "angular momentum L", "v": "velocity v of the centre", "τ": "torque τ",
          "Rω": "speed Rω of the rim"}                                        # what the arrows of a film in 3D mean
TOO_STEEP = 1.5              # by which a slope may be larger than the expected order [-]
ROUNDED = 1e-11              # largest error that is called round-off [-]: of some 1e5 steps
BUSY = 0.25                  # cores that other programs use, from which times are doubtful [-]
BUSY_LOAD = 1.5              # the same where only the load of the machine is known: the run itself counts as 1 [-]


def order(curve):
    """Order of convergence as measured, and in brackets as expected."""
    if curve["expected"] == EXACT:
        return EXACT
    return f"{slope(curve) if shows_order(curve) else '–'} ({curve['expected']})"


def slope(curve):
    """Return the measured order of convergence as text, with a minus sign that is no hyphen."""
    return f"{curve['order']:.2f}".replace("-", "−")


def shows_order(curve):
    """Return whether a measured slope is an order of convergence.

    It is not where no order is expected, and not where it is far steeper than expected.
    """
    order, expected = curve["order"], curve["expected"]
    return order is not None and not (isinstance(expected, int) and (expected == 0 or order > expected + TOO_STEEP))


def with_units(params, table):
    """Return the numbers of a case with their units, such as k = 100 N/m; table: [(name, value, meaning [unit])]."""
    units = {name: re.search(r"\[([^\]]+)\]$", meaning) for name, _, meaning in table}
    shown = {name: unit[1] for name, unit in units.items() if unit and unit[1] != "-"}
    each = (f"{name} = {number(x, 4)} {shown.get(name, '')}".rstrip() for name, x in params.items()
            if isinstance(x, (int, float)) and not isinstance(x, bool))
    return ", ".join(one.replace(" ", "\u00a0") for one in each)               # a line breaks only between two


# ---------------------------------------------------------------------------------------------- verdicts

def judge(curve):
    """Return (text, kind) of a curve's verdict; the kind is a class of the style sheet."""
    verdict = Verdict(curve["verdict"])
    return verdict.value, KINDS[verdict]


def verdicts(curves):
    """Return [(text, kind, count)] of several curves at once."""
    count = Counter(Verdict(c["verdict"]) for c in curves)
    return [(one.value, KINDS[one], count[one]) for one in
            (Verdict.DEPARTS, Verdict.NOT_ATTEMPTED, Verdict.AGREES, Verdict.FOLLOWS_OWN_LAW, Verdict.KEEPS_LAWS,
             Verdict.BREAKS_AS_KNOWN, Verdict.UNDECIDED, Verdict.UNFINISHED, Verdict.REFERENCE)
            if count[one]]


def verdict(curves):
    """Return (text, kind) of the verdict that matters most among several."""
    return verdicts(curves)[0][:2] if curves else ("not done here", "none")


def named(curve):
    """Return a curve's name inside a sentence: pybullet (default)."""
    return engine_name(curve["product"], curve["variant"]) if "product" in curve else curve["label"]


def listed(names):
    """Return names in one sentence; a semicolon separates them if one has a comma that is not in brackets."""
    return ("; " if any("," in re.sub(r"\(.*?\)", "", name) for name in names) else ", ").join(names)


def measured_limits(results, stability):
    """[(place, what it was measured on)] of all limits and tolerances that no theory gives, each once."""
    limits = [(f"{r['scene']}: {c['label']}", c["measured"]) for r in results for one in r["cases"].values()
              for c in one["ours"] + one["engines"] if c["measured"]]
    tolerances = [(f"{case['lesson']}/{case['slug']}: {f['quantity']}", f["tolerance_from"]) for case in stability
                  for f in case["findings"] if f["tolerance_from"]]
    laws = [(f"laws of {kind}: {law['quantity']}", known.MEASURED[law["quantity"]])
            for r in results for one in r["cases"].values() for c in one["ours"] + one["engines"]
            for law in c.get("laws", ()) for kind, known in (("contact", contact_laws), ("joints", joint_laws))
            if law["known"] is not None and law["quantity"] in known.MEASURED]
    return list(dict.fromkeys([*limits, *tolerances, *laws]))


def truths_by_engines(results):
    """[{scene, title, engine, cases}] of the scenes in which the truth is an engine's own run; cases: "" for all."""
    found = []
    for r in results:
        by = {}
        for name, one in r["cases"].items():
            for engine in dict.fromkeys(c["product"] for c in one["engines"] if c["reference"]):
                by.setdefault(engine, []).append(name)
        found += [{"scene": r["scene"], "title": r["title"], "engine": engine,
                   "cases": "" if len(cases) == len(r["cases"]) else ", ".join(cases)} for engine, cases in by.items()]
    return found


def truths_by_agreement(results):
    """Return the results of the scenes whose truth is the motion on which our loop and an engine agree."""
    return [result for result in results if result["agreed"]]


def own_errors(curve):
    """Return [(row, error)] of a curve against the law that it follows instead of the truth; none for most curves."""
    own = curve.get("own_law")
    return [(row, relative_to(row["observed"], own)) for row in curve["rows"] if own and row["observed"]]


def relative_to(observed, law):
    """Return |observed − law| / |law| of two lists."""
    return relative(np.array(observed), np.array(law))


def finest(curve):
    """Return the run of the most steps, or None."""
    return curve["rows"][-1] if curve["rows"] else None


def theory_of(curve, truth):
    """Return {"predicted", "allowed"}: the error of the finest run as theory predicts it, and how far it may be off.

    Both are texts.  Without a prediction, `allowed` is the largest error.
    """
    row = finest(curve)
    if row is None:
        return {"predicted": "–", "allowed": "–"}
    if row["predicted"] is None:
        return {"predicted": "–", "allowed": "–" if row["limit"] is None else f"≤ {number(row['limit'], 2)}"}
    return {"predicted": number(relative_to(row["predicted"], truth), 2), "allowed": f"± {number(row['band'], 2)}"}


# ---------------------------------------------------------------------------------------------- a busy machine

def busy(results):
    """Return (cores that other programs used, at most, while times were taken; True where that is only a load)."""
    others = [r["times"]["others"] for r in results if r["times"].get("others") is not None]
    if others:
        return max(others), False
    loads = [r["times"]["load"][0] for r in results if r["times"].get("load")]
    return max(loads, default=0.0), True


def busy_warning(results, cores):
    """Return one sentence if times are doubtful, else nothing."""
    used, is_load = busy(results)
    if is_load and used >= BUSY_LOAD:
        return (f"The machine was busy while times were taken: its load was up to {used:.1f}, and this run needs 1. "
                "Ratios of times may be off by a factor of two.")
    if not is_load and used >= BUSY:
        return (f"The machine was busy while times were taken: other programs used up to {used:.1f} of its {cores} "
                "cores. Ratios of times may be off by a factor of two.")
    return ""


# ---------------------------------------------------------------------------------------------- the front page

def products(results):
    """Return the engines that a report has columns for: one that is optional only where it ran."""
    ran = {c["product"] for r in results for one in r["cases"].values() for c in one["engines"]}
    return [product.name for product in PRODUCTS if not product.optional or product.name in ran]


def row(result, products):
    """Return one scene on the front page, with these engines."""
    first = next(iter(result["cases"].values()))
    cases = result["cases"].values()
    ours = [c for one in cases for c in one["ours"]]
    engines = {name: [c for one in cases for c in one["engines"] if c["product"] == name] for name in products}
    return {
        "result": result,
        "ours": verdicts(ours),
        "engines": {name: verdicts(curves) for name, curves in engines.items()},
        "recorded": [name for name, curves in engines.items() if curves and not curves[0]["source"].startswith("live")],
        "best": best_order(first["ours"]),
        "races": result["times"]["races"],
        "kinds": sorted({kind for _, kind, _ in verdicts([*ours, *(c for one in engines.values() for c in one)])}),
        "products": [name for name, curves in engines.items() if curves],
    }


def left_out(results):
    """Return the cost of the whole loop in place of the method of each scene: [{scene, title, lesson, …}]."""
    return [{"scene": r["scene"], "title": r["title"], "lesson": r["lesson"], "uses": r["uses"], **whole_loop(r)}
            for r in results]


def whole_loop(result):
    """Return what was measured of the whole loop in a scene; `note` says why there is no number."""
    row = result["times"].get("left_out") or {"ratio": None, "note": ""}
    if row["ratio"] is not None:
        return {**row, "range": cost_range(row)}
    without = "nothing moves here, so there is no loop" if not result["moves"] else \
        "its own method is a loop of this kind already"
    return {**row, "note": row["note"] or without}


def our_parts(results):
    """Return what was left out of our loop in each scene: [{scene, title, lesson, note, found: {part: [its rows]}}].

    Only scenes with a row or a reason are there.
    """
    return [one for r in results if (one := parts_of(r, r["times"].get("our_parts") or {"rows": (), "note": ""}))]


def engine_parts(results):
    """Return what was switched off of the engines: [{scene, title, lesson, note, found: {part: its rows}}]."""
    return [one for r in results if (one := parts_of(r, {"rows": r["times"].get("engine_parts") or (), "note": ""}))]


def parts_of(result, measured):
    """Return the parts of a loop or of engines that were left out in one scene, or None where there is nothing."""
    found = {}
    for row in measured["rows"]:
        found.setdefault(row["part"], []).append(
            {**row, "says": change_without(row), "until": until(row), "range": cost_range(row)})
    if not found and not measured["note"]:
        return None
    return {"scene": result["scene"], "title": result["title"], "lesson": result["lesson"], "note": measured["note"],
            "found": found}


def cost_range(row):
    """Return (lowest, highest) ratio of the times with and without something, from the intervals of both."""
    full, lean = map(interval, row["repeats"])
    return full["low"] / lean["high"], full["high"] / lean["low"]


def omissions(results):
    """Return all that the scenes say they leave out: [{scene, title, what, cost, same, note, range}]."""
    return [{"scene": r["scene"], "title": r["title"], **row, "range": row["cost"] and cost_range(row)}
            for r in results for row in r["times"]["ablations"]]


def engines_of(result):
    """Return a curve of each engine of a scene, in whichever cases it runs."""
    return list({c["label"]: c for case in result["cases"].values() for c in case["engines"]}.values())


def unpredicted(result):
    """Return {reason: labels} of the curves of a scene whose error no theory predicts."""
    found = {}
    for case in result["cases"].values():
        for curve in case["ours"] + case["engines"]:
            if curve["unpredicted"]:
                found.setdefault(curve["unpredicted"], {})[named(curve)] = None
    return {reason: list(labels) for reason, labels in found.items()}


def part_names(parts):
    """Return names of what was switched off anywhere."""
    return list(dict.fromkeys(name for row in parts for name in row["found"]))


def part_products(parts):
    """Return names of the engines of which parts were switched off."""
    measured = {one["product"] for row in parts for rows in row["found"].values() for one in rows}
    return [product.name for product in PRODUCTS if product.name in measured]


def change_without(row):
    """Return what becomes of a motion without a part of the engine, in a word or two."""
    if row["change"] is None:
        return "lost"
    if row["change"] >= 1.0:
        return "another motion"
    return "same" if row["change"] < SAME else f"changes by {percent(row['change'])}".replace(" %", "\u00a0%")


def until(row):
    """Return until when the motion was observed, if that is not the end."""
    return f" (first {percent(row['until'])} of T)".replace(" %", "\u00a0%") if row.get("until", 1.0) < 0.999 else ""


def best_order(curves):
    """Return the curve of ours that agrees and shows the highest order."""
    agreeing = [c for c in curves if Verdict(c["verdict"]) is Verdict.AGREES]
    known = [c for c in agreeing if shows_order(c) or c["expected"] == EXACT]
    return max(known, key=lambda c: (c["expected"] == EXACT, c["order"] or 0.0), default=None)


def to_round_off(curve):
    """Return whether a curve has no error but round-off, at every step."""
    errors = [row["error"] for row in curve["rows"] if row["error"] is not None]
    return curve["expected"] == EXACT and max(errors, default=0.0) <= ROUNDED


def seen_in_steps(result):
    """Return one sentence: the result of the plot of errors against steps."""
    case = next(iter(result["cases"].values()))
    best = best_order(case["ours"])
    if best is None:
        return ""
    if best["expected"] == EXACT:
        return f"“{best['label']}” is exact up to round-off at every step." if to_round_off(best) else ""
    if not any(shows_order(c) for c in case["ours"] if c is not best):
        return f"The error of “{best['label']}” falls with order {slope(best)}."
    return f"Of our methods, “{best['label']}” falls fastest, with order {slope(best)}."


# ---------------------------------------------------------------------------------------------- texts of scenes

def summary_line(story):
    """Return the first sentence or two of a scene's text, as far as its first line."""
    return story.splitlines()[0] if story else ""


TERM = re.compile(r"(?P<term>\S(?:.{0,20}[^\s.,;:=])?)  +(?P<text>[^\s=].*)")
SHAPE = re.compile(r" ?\((?:[nNm](?:, [\dd])?,?|\d,|3, 3)\)")                  # of an array, such as (n, 3)
SUBSCRIPT = re.compile(r"\b([A-Za-zα-ω]{1,4})_([A-Za-zα-ω]{1,4})\b")


def flowing(text):
    """Return [(kind, content)] of a docstring, without the line breaks of its source.

    text: a paragraph;    formula: indented lines, as they are;    terms: [(term, text)] of a list of definitions.
    """
    found = []
    for block in re.split(r"\n\s*\n", text.strip("\n")):
        lines = block.split("\n")
        begin = next((k for k, line in enumerate(lines) if defines(line)), len(lines))
        ends = (k for k in range(begin, len(lines)) if not defines(lines[k]) and not indented(lines[k]))
        end = next(ends, len(lines))
        if sum(map(defines, lines[begin:end])) < 2:
            begin = end = len(lines)
        found += paragraphs(lines[:begin])
        if begin < end:
            found.append(("terms", definitions(lines[begin:end])))
        found += paragraphs(lines[end:])
    return found


def paragraphs(lines):
    """Return text and formulas: indented lines are a formula at the start or after a colon, else they are text."""
    found = []
    for deep, piece in runs_of(lines):
        if deep and (not found or found[-1][1].endswith(":")):
            found.append(("formula", "\n".join(line.strip() for line in piece)))
        elif deep:
            found[-1] = (found[-1][0], plain_words(" ".join([found[-1][1], *piece])))
        else:
            found.append(("text", plain_words(" ".join(piece))))
    return found


def defines(line):
    return bool(TERM.fullmatch(line)) and not indented(line)


def runs_of(lines):
    """Return [(indented, lines)] of neighbours that are all indented or all not."""
    return [(formula, list(piece)) for formula, piece in groupby(lines, key=indented)]


def definitions(lines):
    """Return [(term, text)]: an indented line goes on with the text before."""
    found = []
    for line in lines:
        if defines(line):
            term = TERM.fullmatch(line)
            found.append((term["term"], [term["text"]]))
        else:
            found[-1][1].append(line.strip())
    return [(term, plain_words(" ".join(words))) for term, words in found]


def indented(line):
    return line.startswith("  ")


def plain_words(text):
    """Return a sentence of a docstring for a reader: no imperative to a programmer, no shapes of arrays."""
    text = SHAPE.sub("", re.sub(r"\s+", " ", text).strip().replace("`", ""))
    return re.sub(r"^(Return|Give|Compute) (the )?(?=\S)", "", text)


def subscripts(text):
    """Return v_n with a lowered n."""
    return Markup(SUBSCRIPT.sub(r"\1<sub>\2</sub>", str(escape(text))))


# ---------------------------------------------------------------------------------------------- findings

def headline(result):
    """Return one sentence: the result of this scene."""
    cases = result["cases"].values()
    ours = [c for one in cases for c in one["ours"]]
    engines = [c for one in cases for c in one["engines"]]
    count = Counter(Verdict(c["verdict"]) for c in ours)
    wrong = [c for c in ours + engines if is_right(c) is False]
    if wrong:
        return f"{len(wrong)} of {len(ours) + len(engines)} comparisons depart, and nothing predicted it."
    if count[Verdict.NOT_ATTEMPTED]:
        return f"{count[Verdict.NOT_ATTEMPTED]} of {len(ours)} comparisons of our methods are not attempted yet."
    rest = [f"{count[one]} {single if count[one] == 1 else several}" for one, single, several in (
        (Verdict.UNFINISHED, "does not arrive", "do not arrive"), (Verdict.UNDECIDED, "is undecided", "are undecided"),
        (Verdict.KEEPS_LAWS, "is judged by laws alone", "are judged by laws alone"),
        (Verdict.BREAKS_AS_KNOWN, "breaks a law as known", "break a law as known")) if count[one]]
    right = count[Verdict.AGREES] + count[Verdict.FOLLOWS_OWN_LAW]
    many = f"{right} of {len(ours)}" if rest else "All"
    first = f"{many} comparisons of our methods with the truth come out as theory says"
    said = "; ".join([first, *rest]) if ours else ""
    predicted = {named(c): None for c in ours + engines if Verdict(c["verdict"]) is Verdict.FOLLOWS_OWN_LAW}
    if predicted:
        departed = f"{listed(predicted)} {'departs' if len(predicted) == 1 else 'depart'} as predicted"
        return f"{said}; {departed}." if said else f"{departed}."
    return f"{said}." if said else ""


def findings(result):
    """Return sentences, the most important first, and what was left out at the end."""
    notes = (f"{sentence}." for sentence in result["notes"])
    return [*leading(result), *notes]


def recorded(result):
    """Return a sentence for each engine whose runs are recorded ones, with what ran when they were made."""
    sources = {c["product"]: c["source"] for one in result["cases"].values() for c in one["engines"]}
    return [f"{product}'s runs are {source.replace(', ', ' ones, of ', 1)}." for product, source in sources.items()
            if source.startswith("recorded, ")]


def leading(result):
    """The findings without what was left out: departures first, then orders, times and what an omission saves."""
    return [*_departures(result), *_ours(result), *_engines_of(result), *races.sentences(result), *_ablations(result),
            *_parity(result)]


def _departures(result):
    """Return all departures, ours and the engines', the unpredicted ones first."""
    every = [(n, c) for n, one in result["cases"].items() for c in one["ours"] + one["engines"]]
    for n, c in every:
        if is_right(c) is False:
            yield f"{named(c)} {c['message']}, in the case “{n}”. The scene does not predict it."
    groups = {}
    for n, c in every:
        if Verdict(c["verdict"]) is Verdict.FOLLOWS_OWN_LAW:
            label = named(c) if "product" in c else named(c)[:1].upper() + named(c)[1:]
            groups.setdefault((label, c["departure_reason"], c["departure_whose"]), []).append((n, c))
    for (label, reason, whose), found in groups.items():
        size = percents(*(of(c["departure"] for _, c in found) for of in (min, max)))
        several = f" in {len(found)} cases" if len(found) > 1 else ""
        ordered = sorted((c for _, c in found if c["order"]), key=lambda c: c["order"])
        slopes = " to ".join(dict.fromkeys(map(slope, ordered[:1] + ordered[-1:])))
        shown = f"converges to that law, with order {slopes}" if ordered else "agrees with that law"
        yield (f"{label} departs from the truth by {size}{several}, because {reason} ({whose}). "
               f"The scene predicts this; the run {shown}.")


def _ours(result):
    every = [(n, c) for n, one in result["cases"].items() for c in one["ours"]]
    waiting = {}
    for _, c in every:
        if is_right(c) is None:
            waiting.setdefault(c["message"], {})[c["label"]] = None
    for why, labels in waiting.items():
        yield f"{listed(labels)}: {why}."
    shown = [c for c in next(iter(result["cases"].values()))["ours"]
             if c["order"] is not None and c["expected"] != EXACT and is_right(c)]
    if shown:
        orders = "; ".join(f"{c['label']} {slope(c)} ({c['expected']})" for c in shown)
        yield f"Measured orders of convergence, with the expected order in brackets: {orders}."
    exact = [c["label"] for c in next(iter(result["cases"].values()))["ours"] if to_round_off(c) and is_right(c)]
    if exact and result["refinement"]:
        yield f"Exact up to round-off at every step, as derived: {listed(exact)}."


def _engines_of(result):
    """Yield what the engines do in the first case; of what does not move, only what could not be judged."""
    if result["moves"]:
        yield from _engines(next(iter(result["cases"].values())))
    undecided = {}
    for n, one in result["cases"].items():
        for c in one["engines"]:
            if Verdict(c["verdict"]) is Verdict.UNDECIDED:
                undecided.setdefault(c["message"], {}).setdefault(named(c), []).append(n)
    for why, labels in undecided.items():
        yield f"Undecided: {listed(labels)}. {why[:1].upper()}{why[1:]}."


def _engines(case):
    for c in case["engines"]:
        clear = [r for r in c["rows"] if r["error"] is not None]
        if Verdict(c["verdict"]) is Verdict.AGREES and clear:
            known = c["order"] is not None and c["expected"]
            shown = f", with order {slope(c)} where {c['expected']} is expected" if known else ""
            yield f"{named(c)} agrees with the truth to {percent(clear[-1]['error'])} at its finest step{shown}."


def _ablations(result):
    for row in result["times"]["ablations"]:
        if row["cost"] is not None:
            same = "the motion is the same" if row["same"] else "but the motion changes: look into it"
            if rounded(row["cost"]) == "1.0":
                yield f"Putting in {row['what']} does not change the time of a step; {same}."
            else:
                yield f"Putting in {row['what']} makes a step {rounded(row['cost'])} times as long; {same}."


def _parity(result):
    if result["parity"] is not None:
        yield ("Plain and compiled runs agree to the last bit." if result["parity"] == 0.0 else
               f"Plain and compiled runs differ by at most {number(result['parity'], 2)}, relative.")
