"""The races of a report in words and numbers: each by itself, and all of them together."""

from statistics import median, quantiles

from ..measure.races import BEST, HEADLINE, LEVELS, Outcome
from .numbers import engine_name, factor, percent, rounded, seconds

# factor by which a ratio may lie beyond the interval of another run [-]: measured in three full runs of one commit, in
# which 79 of 100 ratios lay within that interval, and 98.7 of 100 within this factor of it
BETWEEN_RUNS = 1.1


def of(result):
    """Return all races of a scene, each with its scene and with what compiling costs there."""
    compiled = result["times"].get("compilation")
    return [{**race, "scene": result["scene"], "title": result["title"], "lesson": result["lesson"],
             **compiling(race, compiled, result)} for race in result["times"]["races"]]


def every(results):
    """Return all races of a report."""
    return [race for result in results for race in of(result)]


def at(races, level=HEADLINE):
    """Return those of the races that are run to this level."""
    return [race for race in races if race["level"] == level]


def compiling(race, compiled, result):
    """Return {"cold", "cached", "paid"}: seconds to compile our method, to load it, and of motion until that has paid.

    Each second of motion saves what the engine takes longer.  None where this race is run without compiling, where it
    was not measured, or where nothing is saved; `paid` is None as well where nothing moves.
    """
    nothing = {"cold": None, "cached": None, "paid": None}
    ours = race["ours"]
    if not compiled or not ours or (ours["label"], ours["speed"]) != (compiled["label"], "compiled"):
        return nothing
    saved = race["engine"]["seconds"] - ours["seconds"] if race["ratio"] else 0.0
    paid = compiled["cold"] * result["T"] / saved if saved > 0.0 and result["moves"] else None
    return {"cold": compiled["cold"], "cached": compiled["cached"], "paid": paid}


def level_name(level):
    """Return the name of a level in a table or a sentence."""
    return "the engine's best" if level is BEST else percent(level)


# ---------------------------------------------------------------------------------------------- one race

def ratio(race):
    """Return a ratio of times with its interval, or why there is none; all have two digits."""
    if not race["ratio"]:
        return race["outcome"] if race["outcome"] in (Outcome.ENGINE_FAILS, Outcome.NEITHER) else race["why"]
    return with_interval(race)


def with_interval(times):
    """Return the ratio of a race, or a median ratio, with its interval, such as 31× (25 to 38)."""
    low, middle, high = map(rounded, (times["low"] / BETWEEN_RUNS, times["ratio"], times["high"] * BETWEEN_RUNS))
    return f"{middle}× ({low} to {high})"


def coarse_runs(races):
    """Yield sentences about the races of one engine in which a side runs its coarsest timed run, each run once."""
    groups = {}
    for race in races:
        if sides := coarse_sides(race):
            groups.setdefault(sides, []).append(race["level"])
    for sides, levels in groups.items():
        yield coarse_sentence(levels, sides)


def coarse(race):
    """Return the sentence about one race; nothing where both sides need more than their coarsest timed run."""
    sides = coarse_sides(race)
    return coarse_sentence([race["level"]], sides) if sides else ""


def coarse_sides(race):
    """((name, number of steps), …) of the sides that meet a fixed error already with their coarsest timed run."""
    return tuple((name, race[side]["steps"]) for name, side in ((race["product"], "engine"), ("our method", "ours"))
                 if race["level"] is not BEST and race[side] and race[side]["coarsest"])


def coarse_sentence(levels, sides):
    """Return a sentence: these sides meet these errors already with their coarsest timed runs."""
    errors = " and ".join(map(level_name, levels))
    if len(sides) == 2 and sides[0][1] == sides[1][1]:
        return f"Both meet {errors} already in {steps(sides[0][1])}."
    said = " and of ".join(f"{name} ({steps(count)})" for name, count in sides)
    return f"{errors} {'are' if len(levels) > 1 else 'is'} met already by the coarsest timed run of {said}."


def steps(count):
    """Return a number of steps in """
    return "one step" if count == 1 else f"{count} steps"


def sentence(race):
    """Return what one race showed."""
    engine, ours, error = race["engine"], race["ours"], percent(race["error"])
    if not race["ratio"]:
        known = f"{engine_name(race['product'], race['variant'])} reaches an error of {error} in " \
                f"{seconds(engine['seconds'])}. " if engine else ""
        where = "" if engine or race["error"] is None else f" at {error}"
        return f"{known}{race['product']}{where}: {race['outcome']}, because {race['why']}."
    return (f"{engine_name(race['product'], race['variant'])} reaches an error of {error} in "
            f"{seconds(engine['seconds'])}, our “{ours['label']}”, {ours['speed']}, in "
            f"{seconds(ours['seconds'])}: {race['outcome']}, {ratio(race)}. {coarse(race)}").strip()


def sentences(result):
    """Yield what the races of a scene showed: for each engine the headline, and the ratios at the other levels."""
    found = of(result)
    for headline in at(found):
        mine = [race for race in found if race["product"] == headline["product"] and race["level"] != HEADLINE]
        others = [f"{factor(race['ratio'])} {to_error(race, headline)}" for race in mine if race["ratio"]]
        more = f" The engine's time over ours to other errors: {'; '.join(others)}." if others else ""
        yield sentence(headline) + more


def to_error(race, headline):
    """Return to which error a race is, and the engine's settings where they are not those of the headline."""
    error = f"{percent(race['error'])}, the engine's best" if race["level"] is BEST else percent(race["level"])
    same = race["variant"] == headline["variant"]
    return f"to {error}" if same else f"to {error} (by {engine_name(race['product'], race['variant'])})"


# ---------------------------------------------------------------------------------------------- all races

def counted(races):
    """Return a list with a record for each level: how many races ended how, and the median ratio with its interval.

    low, high  the medians of the lower and of the upper ends of the intervals of the races
    decided    races that were won, tied or lost; lost are also those to an error that we do not reach
    """
    found = []
    for level in (*LEVELS, BEST):
        mine = at(races, level)
        decided = [race for race in mine if race["ratio"]]
        quarters = quantiles([race["ratio"] for race in decided], n=4) if len(decided) > 1 else (None,) * 3
        middle = {key: median(race[key] for race in decided) if decided else None for key in ("ratio", "low", "high")}
        ended = outcomes(mine)
        found.append({"level": level, "name": level_name(level), "races": len(mine), **ended, **middle,
                      "decided": ended["faster"] + ended["tie"] + ended["slower"],
                      "lower": quarters[0], "upper": quarters[2], "plain": in_plain_python(mine)})
    return found


def in_plain_python(races):
    """Return in how many races our plain Python reaches the error, and in how many of them it takes less time."""
    found = [race["plain"] for race in races if race.get("plain") is not None]
    return {"races": len(found), "faster": sum(ratio > 1.0 for ratio in found)}


def rows(races):
    """[{race, by_level, parts}]: for each engine in a scene its race at the headline's error, those at all errors, and
    what the ratio is made of.
    """
    found = []
    for race in at(races):
        same = [other for other in races if (other["scene"], other["product"]) == (race["scene"], race["product"])]
        found.append({"race": race, "by_level": same, "parts": parts(race)})
    return found


def parts(race):
    """[(name, kind, value)] of what the ratio of a race is made of; a value is None where it is not known."""
    return [(f"order, at {percent(HEADLINE)}", "order", race["order"]), ("loop", "loop", race["loop"]),
            ("calls from Python, in it", "calls", race["calls"])]


def outcomes(races):
    """Return how many races ended how, by the names of the outcomes."""
    return {outcome.name.lower(): sum(Outcome(race["outcome"]) is outcome for race in races) for outcome in Outcome}


def summary_ratio(count):
    """Return a median ratio with its interval."""
    return "–" if count["ratio"] is None else with_interval(count)


def headline_of(counts):
    """Return the record of the headline's level."""
    return next(count for count in counts if count["level"] == HEADLINE)


def median_factors(races):
    """Return {order, loop, calls, cold, cached, paid}, medians of what ratios at the headline are made of.

    parted, ratios: how many races there have an order and a loop, and how many have a ratio
    """
    found = {}
    for key in ("order", "loop", "calls", "cold", "cached", "paid"):
        values = [race[key] for race in at(races) if race[key] is not None]
        found[key] = median(values) if values else None
    return {**found, "parted": sum(race["order"] is not None for race in at(races)),
            "ratios": sum(race["ratio"] is not None for race in at(races))}
