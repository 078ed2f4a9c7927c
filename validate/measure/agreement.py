"""The truth of the dominoes: two codes that share nothing, with steps so short that their motions agree.

`python -m validate.measure.agreement` computes it in about three minutes and keeps it in validate/recorded/.
"""

import json

from ..methods import SETTLED_LOOP
from ..reference.stored import RECORDED, kept, key_of
from ..run.command import start
from ..run.store import whole
from ..scenes.simulator import dominoes
from ..subject import modules
from .accuracy import relative

LOOP, PYMUNK = 20_000, 50_000        # steps per second of the loop and of pymunk; the error bar has both halved, too


def motions(p):
    """Return {(code, steps per second): (film, ends)} of both codes, with these steps and with twice as long ones."""
    scene = modules.bind_scene("dominoes", compiled=True)
    step = getattr(scene.lessons.simulator, SETTLED_LOOP.function)
    found = {}
    for share in (1, 2):
        found["pymunk", PYMUNK // share] = [dominoes.by_pymunk(p, *run) for run in dominoes.two_runs(PYMUNK // share)]
        found["loop", LOOP // share] = [dominoes.by_loop(scene.lessons, step, scene.law, p, *run)
                                        for run in dominoes.two_runs(LOOP // share)]
    return found


def agreement(p):
    """Return {film, ends, bar, apart, of} of a case: the mean of both codes, and how far they are from it.

    bar: the largest distance of the four runs at T, relative to all corners;    apart: the distance of the two finest
    at every tenth of a second
    """
    found = motions(p)
    fine = [found["pymunk", PYMUNK], found["loop", LOOP]]
    film, ends = (0.5 * (a + b) for a, b in zip(*fine))
    corners = lambda places: dominoes.all_corners(places, p)
    bar = max(relative(corners(one[1][-1]), corners(ends[-1])) for one in found.values())
    tenth = dominoes.KEPT // 10
    apart = [relative(corners(a), corners(b)) for a, b in zip(fine[0][0][::tenth], fine[1][0][::tenth])]
    return {"film": film[:, 0].round(5).tolist(), "ends": ends[-1].round(8).tolist(), "bar": float(f"{bar:.3g}"),
            "apart": [float(f"{off:.2g}") for off in apart],
            "of": [f"{code}, {steps:,} steps per second" for code, steps in found]}


def main():
    """Compute the agreement of all cases, print it, and keep it with the record of the scene."""
    record = kept("dominoes")
    record["agreed"] = {}
    for name, p in dominoes.CASES.items():
        found = record["agreed"][key_of(p)] = agreement(p)
        print(f"{name}: {found['bar']:.2g} at {dominoes.T:g} s; the two finest runs over the time: "
              + ", ".join(f"{0.1 * k:.1f} s {off:g}" for k, off in enumerate(found["apart"])))
    with whole(RECORDED / "dominoes.json") as draft:
        draft.write_text(json.dumps(record, separators=(",", ":")) + "\n")


if __name__ == "__main__":
    start("python -m validate.measure.agreement", main)
