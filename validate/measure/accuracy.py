"""Errors of every method and engine of a scene, the orders that they show, and the verdicts on them."""

import warnings
from typing import NamedTuple

import numpy as np

from solutions.checks import BadInput

from ..check import BY_LAWS, JointsAllowed, Role, Verdict, jsonable
from ..engines.watched import steps_of_motion
from ..methods import engine_look
from ..reference import contact_laws, joint_laws
from ..reference.laws import Law
from ..reference.stored import agreed
from ..scene import ROUND_OFF, parameter_table
from ..subject.modules import report_text
from . import film, traces
from .selection import select, with_overrides

ASYMPTOTIC = 0.5             # limits above this are not compared with a run [-]
HEADLINE = 0.01              # relative error of the races that a summary states [-]
LEAST_STEPS = 2              # of a run that a sweep adds at its coarse end


class Outcome(NamedTuple):
    """What a run observed at T, or why it could not."""
    observed: np.ndarray | None
    failure: str | None = None
    attempted: bool = True
    laws: list | None = None             # of contact, in its watched steps: fields of each Law


@with_overrides
def errors(name, plan):
    """Return everything about a scene but its run times: a dict that JSON can hold."""
    selection = select(name, plan)
    scene, cases = selection.scene, {}
    for case, p in selection.cases.items():
        # a quick run asks engines for one case of a motion
        with_engines = not cases or not plan.quick or not scene.moves
        cases[case] = case_errors(selection, case, p, with_engines)
    _, first = selection.first
    return jsonable({
        "scene": name, "quick": plan.quick, "title": scene.title, "lesson": scene.lesson, "story": scene.story,
        "moves": scene.moves, "refinement": scene.refinement, "T": scene.duration,
        "agreed": any(agreed(name, p) for p in scene.cases.values()),
        "uncertainty": scene.truth_uncertainty, "truth_story": report_text(scene.truth), "uses": list(scene.uses),
        "parameters": parameter_table(scene.parameters), "notes": selection.notes, "cases": cases,
        **parity(selection, first),
        "picture": film.picture(selection, first, labels_to_film({"cases": cases})),
        "law": report_text(scene.law) if scene.law else "",
        "limits": theory(scene),
    })


def theory(scene):
    """Return what the scene says about its limits and predictions: the texts of their functions."""
    functions = [f for r in scene.runners for f in (r.limit, r.predicted) if callable(f)]
    return "\n\n".join(filter(None, dict.fromkeys(report_text(getattr(f, "func", f)) for f in functions)))


def case_errors(selection, case, p, with_engines):
    """Return the errors of one case: its truth, and the curves of our methods and the engines."""
    scene = selection.scene
    truth = np.array(scene.truth(p, scene.duration), dtype=float)
    engines_here = selection.engines_for(p) if with_engines else ()
    return {
        "params": p._asdict() if hasattr(p, "_asdict") else {},
        "truth": truth.tolist(), "error_bar": (agreed(selection.name, p) or {}).get("bar"),
        "quantities": scene.quantity_names(p) if scene.quantity_names else [],
        "ours": [*(our_curve(selection, r, p, truth) for r in selection.ours_for(p)),
                 *(unfinished_curve(r, why) for r, why in selection.unfinished_for(p))],
        "engines": [engine_curve(selection, case, r, p, truth) for r in engines_here],
    }


def unfinished_curve(runner, why):
    """Return the curve of a method of ours that does not come to its end in a case: it has no runs, and says why."""
    return {"label": runner.label, "rows": [], "order": None, "expected": runner.order, "verdict": Verdict.UNFINISHED,
            "message": why, "departure_reason": "", "unpredicted": "", "measured": runner.measured, "reference": False,
            "laws": [], **our_look(runner)}


# ---------------------------------------------------------------------------------------------- runs

def run_to_end(scene, step, p, steps, asked=False, allowed=None):
    """Return the Outcome of one of our methods at T.

    allowed: the laws of contact then judge its watched steps, with what they allow it
    asked: whether a user changed the parameters.  Only then BadInput is raised again.  For the scene's own parameters
    a refusal is a failure of the method.
    """
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            state, kept = run_ours(scene, step, p, steps, steps_of_motion(steps) if allowed else ())
            observed = scene.observe(state, p)
    except ArithmeticError as e:
        return Outcome(None, str(e))
    except np.linalg.LinAlgError as e:
        return Outcome(None, f"Newton's matrix is singular: {e}")
    except NotImplementedError as e:
        return Outcome(None, f"{Verdict.NOT_ATTEMPTED.value}: {e}", attempted=False)
    except BadInput as e:
        if asked:
            raise
        return Outcome(None, f"refused: {e}")
    except (Exception, SystemExit) as e:  # a subject's code may raise anything: report it, and go on
        return Outcome(None, f"{type(e).__name__}: {str(e).strip().splitlines()[0] if str(e).strip() else ''}")
    return finite(observed)._replace(laws=laws_of(kept, allowed) if allowed else None)


def run_ours(scene, step, p, steps, watched):
    """Return (state at T, [Step, …] that our loop reports of the steps with these numbers)."""
    dt, state, kept, now = scene.duration / steps, scene.start(p), [], 0
    run = lambda state, steps: scene.run(scene.lessons, step, scene.law, state, p, dt, steps)
    for n in sorted(watched):
        before = run(state, n - now) if n > now else state
        state, now = run(before, 1), n + 1
        kept.append(scene.reports(before, state, p, dt))
    return run(state, steps - now) if steps > now else state, kept


def laws_of(kept, allowed):
    """Return the fields of each Law, for the Steps or Readings that a run has kept."""
    return [law._asdict() for law in laws_for(allowed).judged(kept, allowed)]


def laws_for(allowed):
    """Return the module of the laws that judge what is allowed so."""
    return joint_laws if isinstance(allowed, JointsAllowed) else contact_laws


def watched_numbers(allowed, steps):
    """Return the numbers of the steps that laws look at: every one where joints could open."""
    return range(steps) if isinstance(allowed, JointsAllowed) else steps_of_motion(steps)


def run_engine_to_end(scene, engine, p, steps, allowed=None):
    """Return the Outcome of an engine after this number of steps.

    allowed: laws then judge its watched steps, with what they allow it
    """
    world, kept = engine.make(p, scene.duration / steps), []
    watched = watched_numbers(allowed, steps) if allowed and world.watched_step else ()
    try:
        for n in range(steps // engine.substeps):
            if n in watched:
                kept.append(world.watched_step())
            else:
                world.step()
        observed = np.array(world.read(), dtype=float)
        kept += world.watched() if allowed and world.watched else []
    finally:
        world.close()
    return finite(observed)._replace(laws=laws_of(kept, allowed) if allowed else None)


def finite(observed):
    """Return the Outcome of a run that ended."""
    return Outcome(observed) if np.all(np.isfinite(observed)) else Outcome(None, "not finite")


def relative(observed, truth):
    """Return |observed − truth| / |truth|, Euclidean norms over everything observed.

    Absolute where the truth is zero.
    """
    return relative_to(truth, observed, truth)


def relative_to(truth, a, b):
    """Return |a − b| / |truth|; absolute where the truth is zero."""
    size = np.linalg.norm(truth)
    return float(np.linalg.norm(a - b) / (size if size > 0.0 else 1.0))


# ---------------------------------------------------------------------------------------------- curves

def our_curve(selection, runner, p, truth):
    """Return the errors of one of our methods over the sweep."""
    scene, step = selection.fastest(runner)
    runs = swept(selection, runner, p, truth, lambda n: run_to_end(
        scene, step, p, n, bool(selection.plan.overrides), runner.judged_by(p, n)))
    found = judged(scene, runner, p, truth, runs, selection.plan.enough())
    return {**found, **our_look(runner)}


def swept(selection, runner, p, truth, run):
    """Yield (number of steps, Outcome) of a sweep, from coarse to fine; run(steps) gives the Outcome.

    If the coarsest run of a race meets the error of the headline, a coarser one might meet it in less time.  So the
    sweep of a full validation begins with a run that does not, or with LEAST_STEPS.
    """
    steps = selection.steps_of(runner, p)
    begin = [(n, run(n)) for n in steps[:1]]
    if begin and selection.races(p):
        at_once = runner.who.substeps if runner.is_engine else 1
        while meets(begin[0][1], truth) and (n := begin[0][0] // 2 // at_once * at_once) >= LEAST_STEPS:
            begin.insert(0, (n, run(n)))
    yield from begin
    yield from ((n, run(n)) for n in steps[1:])


def meets(outcome, truth):
    """Return whether a run has met the error of the headline's race."""
    return not outcome.failure and relative(outcome.observed, truth) <= HEADLINE


def our_look(runner):
    """Return how the curve of a method of ours is drawn."""
    return {"role": Role.OURS, "colour": runner.who.colour, "marker": runner.who.marker, "line": "-"}


def engine_curve(selection, case, runner, p, truth):
    """Return an engine's errors: live if it is installed, recorded otherwise."""
    scene, engine = selection.scene, runner.who
    colour, marker, line = engine_look(engine, [r.who for r in scene.engine_runners])
    about = {"role": Role.ENGINE, "product": engine.product.name, "variant": engine.variant,
             "settings": engine.settings, "substeps": engine.substeps,
             "colour": colour, "marker": marker, "line": line}
    if selection.is_live(runner):
        source = f"live, {engine.product} {engine.product.installed()}"
        runs = swept(selection, runner, p, truth,
                     lambda n: run_engine_to_end(scene, engine, p, n, runner.judged_by(p, n)))
    else:
        record = traces.recorded(selection.name, case, engine)
        if record is None:
            message = f"{engine.product} is not installed here and this case was never recorded"
            nothing = {"label": engine.label, "rows": [], "order": None, "expected": runner.order,
                       "verdict": Verdict.UNDECIDED}
            return {**about, **nothing, "source": "missing", "message": message, "departure_reason": "",
                    "unpredicted": reason(runner), "measured": runner.measured,
                    "reference": runner.is_reference(p), "laws": []}
        source = record["source"]
        runs = [(r["steps"], Outcome(np.array(r["observed"]) if r["observed"] else None, r["failure"],
                                    laws=r.get("laws"))) for r in record["runs"]]
    found = judged(scene, runner, p, truth, runs, selection.plan.enough())
    return {**about, **found, "source": source}


def reason(runner):
    """Return the reason why no theory predicts the error of a runner; empty if one does."""
    return "" if callable(runner.predicted) else runner.predicted


def bound(runner, p, dt, law):
    """Return what theory says about a run with steps of dt: {"limit", "predicted", "band"} of its row.

    limit      the largest relative error; with a prediction its size and its band
    predicted  what theory says will be observed: `law`, the truth or the own law, and the error; None without one
    band       the largest distance of what is observed from that, relative to the law
    """
    prediction = runner.prediction(p, dt)
    if not prediction:
        return {"limit": runner.largest_error(p, dt), "predicted": None, "band": None}
    predicted = law + np.array(prediction.error, dtype=float)
    limit = relative(predicted, law) + prediction.band
    return {"limit": limit, "predicted": predicted, "band": prediction.band}


def judged(scene, runner, p, truth, runs, enough):
    """Return the curve of a method or an engine: its errors over the sweep, the order that they show, and the verdict.

    runs: pairs (number of steps, Outcome), from coarse to fine; none is taken after `enough` that arrive and can be
    judged.
    Where the scene gives it its own law, it must follow that law.  Where that is the truth, it departs from nothing.
    """
    departure, order = runner.departure, runner.order
    law = truth if departure is None else np.array(departure.own_law(p, scene.duration), dtype=float)
    departure = None if np.array_equal(law, truth) else departure
    rows, laws = [], []
    for steps, outcome in runs:
        laws = outcome.laws or laws
        rows.append({"steps": steps, "dt": scene.duration / steps, "observed": outcome.observed,
                     "error": None if outcome.failure else relative(outcome.observed, truth),
                     "failure": outcome.failure, **bound(runner, p, scene.duration / steps, law)})
        arrived = [r for r in rows if r["error"] is not None and r["steps"] in scene.steps]
        if sum(r["limit"] < ASYMPTOTIC for r in arrived) >= enough:
            break
    off = rows if departure is None else [{**r, "error": r["error"] and relative(r["observed"], law)} for r in rows]
    order_shown = shown_order(off, 10.0 * scene.truth_uncertainty)
    verdict, message = verdict_on(off, law, outcome, order, order_shown)
    laws = laws if verdict is Verdict.UNDECIDED else []
    if laws:
        verdict, message = laws_for(runner.laws).verdict_on([Law(**law) for law in laws])
    if runner.is_reference(p):
        verdict, message = Verdict.REFERENCE, ""
    found = {"label": runner.label, "rows": rows, "order": order_shown, "expected": order, "verdict": verdict,
             "message": message, "departure_reason": "", "unpredicted": reason(runner), "measured": runner.measured,
             "reference": runner.is_reference(p), "laws": laws}
    if departure is None:
        return found
    return {**found, "verdict": Verdict.FOLLOWS_OWN_LAW if verdict is Verdict.AGREES else verdict,
            "departure_reason": departure.reason, "departure_whose": departure.whose,
            "departure": relative(law, truth), "own_law": law}


def verdict_on(rows, law, finest, order, order_shown):
    """Return (Verdict, message) on the rows of a curve; `finest` is the Outcome at the finest step.

    A limit holds only where it is small: an expansion in powers of dt says nothing about a step for which it promises
    50 %.  An order is compared with theory where two steps have small limits; predicted errors contain it already.
    """
    small = [r for r in rows if r["limit"] < ASYMPTOTIC]
    ratios = [r["error"] / r["limit"] for r in small if r["error"] is not None]
    if not finest.attempted:
        return Verdict.NOT_ATTEMPTED, finest.failure
    if finest.failure:
        return Verdict.DEPARTS, f"fails at the finest step: {finest.failure}"
    if not any(np.isfinite(r["limit"]) for r in rows):
        return Verdict.UNDECIDED, "no theory says how far it may be off, so its error is shown and not judged"
    if not ratios:
        return Verdict.UNDECIDED, "the sweep is too coarse to judge: theory allows 50 % or more at its finest step"
    if surprise := next(filter(None, (surprise_in(r, law) for r in reversed(rows))), None):
        return Verdict.DEPARTS, surprise
    if max(ratios) > 1.0:
        return Verdict.DEPARTS, f"departs from truth by {max(ratios):.3g} times what theory allows"
    too_low = order in (1, 2, 4) and order_shown is not None and order_shown < order - 0.3
    if too_low and sum(r["predicted"] is None for r in small) >= 2:
        return Verdict.DEPARTS, f"converges with order {order_shown:.2f}, theory says {order}"
    return Verdict.AGREES, ""


def surprise_in(row, law):
    """Return a sentence without its subject if the error of a run differs from its prediction; None otherwise."""
    if row["predicted"] is None or row["error"] is None:
        return None
    off, size = relative_to(law, row["observed"], row["predicted"]), relative(row["predicted"], law)
    if off <= row["band"]:
        return None
    share, at = row["error"] / size if size > 0.0 else np.inf, f"at {row['steps']} steps"
    if share > 1.01:
        return f"errs {share:.3g} times as much as theory predicts {at}"
    if share < 0.99:
        return f"errs only {share:.2g} of what theory predicts {at}: it is another method than its name says"
    return f"errs as much as theory predicts {at}, but in another way: the two errors differ by {off / size:.2g} of it"


def shown_order(rows, floor):
    """Return the order over the finest four runs whose error exceeds the truth's uncertainty and round-off.

    Runs coarser than the last failed one are ignored.  None if fewer than three runs are left.
    """
    lost = [k for k, r in enumerate(rows) if r["error"] is None or r["error"] >= ASYMPTOTIC]
    clear = [(r["dt"], r["error"]) for r in rows[lost[-1] + 1 if lost else 0:]
             if r["error"] > max(1e-11 + floor, 100.0 * ROUND_OFF * r["steps"])]
    return float(np.polyfit(*np.log(clear[-4:]).T, 1)[0]) if len(clear) >= 3 else None


# ------------------------------------------------------------------------------------------ both speeds, and who agrees

def parity(selection, p):
    """Return what plain and compiled runs of the same methods observed, and their largest relative difference.

    parity is None where no method has both.
    """
    rows = []
    for runner in selection.ours_for(p):
        if len(selection.speeds(runner)) == 2:
            bound = (selection.bound(runner, speed) for speed in selection.plan.speeds)
            a, b = (run_to_end(scene, step, p, scene.steps[0]).observed for scene, step in bound)
            if a is not None and b is not None:
                rows.append({"label": runner.label, "plain": a, "compiled": b})
    return {"parity": max((relative(row["plain"], row["compiled"]) for row in rows), default=None), "parity_rows": rows}


def labels_that_agree(result):
    """Return labels of our methods that agree with the truth in the first case."""
    first = next(iter(result["cases"].values()))
    return {c["label"] for c in first["ours"] if Verdict(c["verdict"]) is Verdict.AGREES}


def labels_to_film(result):
    """Return the same; where no theory gives the error of any of them, those that came to the end."""
    first = next(iter(result["cases"].values()))
    ended = {c["label"] for c in first["ours"] if c["verdict"] in (Verdict.UNDECIDED, *BY_LAWS) and c["rows"]
             and c["rows"][-1]["failure"] is None}
    return labels_that_agree(result) or ended
