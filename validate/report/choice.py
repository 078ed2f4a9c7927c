"""Which method should I use?  For each lesson the cheapest method at two errors, and the safest at large steps.

Every scene of a lesson whose step can be refined has one vote each.  Our methods that agree with the truth stand for
election, at the one speed at which most of them were timed.
"""

from collections import Counter
from math import inf, log

from ..check import Verdict
from ..measure.accuracy import ASYMPTOTIC
from ..measure.timing import TARGETS

CHEAP = (1e-2, 1e-4)         # relative errors at which the cheapest method is named [-]
SPEEDS = ("compiled", "plain")


def by_lesson(results):
    """[{lesson, scenes, cheapest: [a choice for each of CHEAP], safest}] of the lessons that have such scenes.

    A choice is {label, wins, of}: a method, the scenes in which it is best, and the scenes that could vote; or None.
    """
    found = []
    for lesson in dict.fromkeys(result["lesson"] for result in results):
        mine = [result for result in results if result["lesson"] == lesson and result["refinement"]]
        votes = [[costs(result, error) for result in mine] for error in CHEAP]
        found.append({"lesson": lesson, "scenes": len(mine), "cheapest": [elected(one) for one in votes],
                      "safest": elected([largest_steps(result) for result in mine])})
    return found


def candidates(result):
    """Return the curves of our methods that agree with the truth in the case that is timed."""
    first = next(iter(result["cases"].values()))
    return [curve for curve in first["ours"] if Verdict(curve["verdict"]) is Verdict.AGREES]


def speed_of(result):
    """Return the speed at which most of our methods were timed; compiled where that is equal."""
    labels = {curve["label"] for curve in candidates(result)}
    count = Counter(row["speed"] for row in result["times"]["time_to_error"] if row["label"] in labels)
    return max(SPEEDS, key=lambda speed: count[speed])


def costs(result, error):
    """{label: seconds to that error} of our methods in one scene, infinite for one that does not get there."""
    labels, speed, place = {curve["label"] for curve in candidates(result)}, speed_of(result), TARGETS.index(error)
    return {row["label"]: row["seconds"][place] or inf for row in result["times"]["time_to_error"]
            if row["label"] in labels and row["speed"] == speed}


def largest_steps(result):
    """{label: a number that is smaller the larger the steps are that a method bears} in one scene.

    It is the least number of steps from which on no run is lost, and a little more for a larger error there.
    """
    found = {}
    for curve in candidates(result):
        kept = []
        for row in reversed(curve["rows"]):
            if row["error"] is None or row["error"] >= ASYMPTOTIC:
                break
            kept.append(row)
        found[curve["label"]] = kept[-1]["steps"] * (1.0 + kept[-1]["error"]) if kept else inf
    return found


def elected(votes):
    """Return the choice of several scenes: the method that is best in most of them; of equals, the one that is nearer
    to the best in all others.  None where no method gets there in any scene.
    """
    valid = [vote for vote in votes if vote and min(vote.values()) < inf]
    if not valid:
        return None
    wins = Counter(label for vote in valid for label, cost in vote.items() if cost == min(vote.values()))
    label = max(wins, key=lambda label: (wins[label], -sum(behind(vote, label) for vote in valid)))
    return {"label": label, "wins": wins[label], "of": len(valid)}


FAR = 20.0                   # how far a method is behind where it is not run or does not get there, as a logarithm [-]


def behind(vote, label):
    """Return how far a method is behind the best in one scene, as the logarithm of a ratio, at most FAR."""
    cost = vote.get(label, inf)
    return min(FAR, log(cost / min(vote.values()))) if cost < inf else FAR


def scenes(results):
    """Return (scene, lesson, and for each of the three questions the best method and its cost) of every scene."""
    rows = []
    for result in results:
        if result["refinement"]:
            votes = [*(costs(result, error) for error in CHEAP), largest_steps(result)]
            best = [min(vote.items(), key=lambda pair: pair[1], default=("", inf)) for vote in votes]
            rows.append((result["scene"], result["lesson"], speed_of(result),
                         *(cell for label, cost in best for cell in ((label, cost) if cost < inf else ("", None)))))
    return rows
