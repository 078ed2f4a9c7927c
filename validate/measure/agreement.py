"""Truths of scenes without a formula: two codes that share nothing, with steps so short that their motions agree.

`python -m validate.measure.agreement` computes them in about five minutes and keeps them in validate/recorded/.
"""

import json

from ..methods import SETTLED_LOOP
from ..reference.stored import RECORDED, kept, key_of
from ..run.command import start
from ..run.store import whole
from ..scenes.simulator import dominoes, machine
from ..subject import modules
from .accuracy import relative

SCENES = {"dominoes": dominoes, "machine": machine}


def motions(name, p):
    """Return {(code, steps per second): (film, ends)} of both codes, with their finest steps and with twice as long."""
    home, scene = SCENES[name], modules.bind_scene(name, compiled=True)
    step, found = getattr(scene.lessons.simulator, SETTLED_LOOP.function), {}
    for share in (1, 2):
        pymunk, loop = home.FINEST["pymunk"] // share, home.FINEST["loop"] // share
        found["pymunk", pymunk] = home.motion_by_pymunk(p, pymunk)
        found["loop", loop] = home.motion_by_loop(scene.lessons, step, scene.law, p, loop)
    return found


def agreement(name, p):
    """Return {film, ends, bar, apart, of} of a case: the mean of both codes, and how far they are from it.

    bar: the largest distance of the four runs at T, relative to all corners;    apart: the distance of the two finest
    at every tenth of T
    """
    home, found = SCENES[name], motions(name, p)
    fine = list(found.values())[:2]
    film, ends = (0.5 * (a + b) for a, b in zip(*fine))
    corners = lambda places: home.all_corners(places, p)
    bar = max(relative(corners(one[1]), corners(ends)) for one in found.values())
    tenth = round(home.T * home.KEPT / 10)
    apart = [relative(corners(a), corners(b)) for a, b in zip(fine[0][0][::tenth], fine[1][0][::tenth])]
    return {"film": film.round(5).tolist(), "ends": ends.round(8).tolist(), "bar": float(f"{bar:.3g}"),
            "apart": [float(f"{off:.2g}") for off in apart],
            "of": [f"{code}, {steps:,} steps per second" for code, steps in found]}


def main():
    """Compute the agreement of all cases, print it, and keep it with the record of its scene."""
    for name, home in SCENES.items():
        record = kept(name)
        record["agreed"] = {}
        for case in home.AGREED_CASES:
            p = home.CASES[case]
            found = record["agreed"][key_of(p)] = agreement(name, p)
            print(f"{name}, {case}: {found['bar']:.2g} at {home.T:g} s; the two finest runs over the time: "
                  + ", ".join(f"{0.1 * k * home.T:.1f} s {off:g}" for k, off in enumerate(found["apart"])))
        with whole(RECORDED / f"{name}.json") as draft:
            draft.write_text(json.dumps(record, separators=(",", ":")) + "\n")


if __name__ == "__main__":
    start("python -m validate.measure.agreement", main)
