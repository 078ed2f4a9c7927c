"""The film of a scene: its truth, our method of highest order, and an engine, frame by frame."""

import base64

import numpy as np

from ..check import Role
from . import traces

FRAMES = 120
COLOURS = {Role.TRUTH: ("#8f8f8f",), Role.ENGINE: ("#D55E00",), Role.OURS: ("#0072B2", "#009E73", "#CC79A7", "#E69F00")}


def picture(selection, p, agreeing):
    """Return the film of a case as data: one entry for each run, with its role, its colour and its frames."""
    scene = selection.scene
    if not scene.moves:
        if scene.our_film is None:
            there = np.array(scene.truth(p, scene.duration), dtype=float)
            seconds, shown = 0.0, {scene.film_of_truth: (Role.TRUTH, [there])}
        else:
            seconds, frames = scene.our_film(p)
            shown = {"our run": (Role.OURS, frames)}
        return {"seconds": seconds, "dt": 0.0, "links": links(scene, p), "look": scene.link_look,
                "films": films(scene, shown, p), "space": in_space(scene, shown, p, seconds or 1.0)}
    steps = scene.steps[min(selection.plan.enough() + 1, len(scene.steps) - 2) - 1]      # finer than what is judged
    per_frame = max(1, steps // FRAMES)
    seconds = scene.film_seconds or scene.duration
    dt = seconds / (per_frame * FRAMES)
    frames = [np.array(scene.truth(p, seconds * k / FRAMES)) for k in range(FRAMES + 1)]
    shown = {scene.film_of_truth: (Role.TRUTH, frames)} | our_run(selection, p, agreeing, dt, per_frame)
    for runner in scene.engine_runners:
        if selection.is_live(runner) and not runner.departure:
            shown[runner.label] = (Role.ENGINE, engine_frames(runner.who, p, dt, per_frame))
            break
    runs = films(scene, shown, p)
    if not selection.plan.overrides and not any(role is Role.ENGINE for role, _ in shown.values()):
        runs += traces.film_of(selection.name, COLOURS[Role.ENGINE][0])
    return {"seconds": seconds, "dt": dt, "links": links(scene, p), "look": scene.link_look, "films": runs,
            "space": in_space(scene, shown, p, seconds)}


def films(scene, shown, p):
    """Return [{label, role, colour, frames}] in drawing coordinates."""
    each = zip(shown.items(), colours(role for role, _ in shown.values()))
    return [{"label": label, "role": role, "colour": colour,
             "frames": [scene.points(observed, p).tolist() for observed in film]}
            for (label, (role, film)), colour in each]


def colours(roles):
    """Return a colour for each run: grey for the truth, vermilion for an engine, blue and others for ours."""
    own = iter(COLOURS[Role.OURS] * 3)
    return [next(own) if Role(role) is Role.OURS else COLOURS[Role(role)][0] for role in roles]


def in_space(scene, shown, p, seconds):
    """Return the same motion for the 3D player; None where the scene does not say what its bodies look like."""
    if scene.bodies is None:
        return None
    runs = {label: (role, [scene.poses(observed, p) for observed in film]) for label, (role, film) in shown.items()}
    arrows = {}
    if scene.arrows is not None:
        for label, (_, film) in shown.items():
            each = [scene.arrows(observed, p) for observed in film]
            arrows[label] = {name: [one[name] for one in each] for name in each[0]}
    walls = scene.walls(p) if scene.walls else ()
    return packed(scene.bodies(p), runs, seconds, arrows, scene.trail, scene.ground, walls)


def packed(bodies, runs, seconds, arrows=None, trail=None, ground=False, walls=()):
    """Return the data of the 3D player.

    bodies    shapes of validate/scenes/drawing.py
    runs      {label: (role, poses)}; poses (frames, bodies, 7): position x, y, z [m] and unit quaternion w, x, y, z
    arrows    {label: {name: (frames, 2, 3)}}: where each arrow begins and ends, for the runs that have them
    trail     number of the body whose path is drawn;   ground: draw the plane z = 0
    walls     pairs of points: edges of what stands still, such as a container, drawn as thin lines
    """
    arrows = arrows or {}
    names = list(next(iter(arrows.values()), {}))
    entries = []
    for colour, (label, (role, poses)) in zip(colours(role for role, _ in runs.values()), runs.items()):
        poses = np.asarray(poses, dtype=float).reshape(len(poses), -1)
        pointers = np.zeros((len(poses), 6 * len(names)))
        if names and label in arrows:
            pointers = np.hstack([np.asarray(arrows[label][n], dtype=float).reshape(len(poses), 6) for n in names])
        frames = np.hstack([poses, pointers]).astype("<f4")
        entries.append({"label": label, "look": Role(role).value, "colour": colour,
                        "frames": base64.b64encode(frames.tobytes()).decode()})
    return {"seconds": float(seconds), "ground": ground, "trail": trail, "arrows": names, "bodies": list(bodies),
            "walls": np.asarray(walls, dtype=float).reshape(-1, 2, 3).tolist(), "runs": entries}


def links(scene, p):
    """Return pairs of points that the picture joins."""
    return [list(map(int, pair)) for pair in scene.links(p)] if scene.links else []


def our_run(selection, p, agreeing, dt, per_frame):
    """Return {label: (role, frames)} of our method of highest order that does not diverge with these steps, or {}."""
    for runner in sorted((r for r in selection.scene.our_runners if r.label in agreeing), key=selection.rank):
        try:
            return {runner.label: (Role.OURS, our_frames(*selection.fastest(runner), p, dt, per_frame))}
        except ArithmeticError:                          # it needs shorter steps than the film has: the next one, then
            continue
    return {}


def our_frames(scene, step, p, dt, per_frame):
    """Return what our method observes at every frame."""
    state, film = scene.start(p), []
    for _ in range(FRAMES + 1):
        film.append(scene.observe(state, p))
        state = scene.run(scene.lessons, step, scene.law, state, p, dt, per_frame)
    return film


def engine_frames(engine, p, dt, per_frame):
    """Return what an engine reads at every frame."""
    world = engine.make(p, dt)
    film = []
    try:
        for _ in range(FRAMES + 1):
            film.append(np.array(world.read(), dtype=float))
            for _ in range(per_frame):
                world.step()
    finally:
        world.close()
    return film
