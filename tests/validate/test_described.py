"""Scenes as Models: engines err by default as with the settings of a scene, and within the limits that it derives."""

import numpy as np
import pytest

from validate.engines.products import BUILDERS, MUJOCO
from validate.measure.accuracy import ASYMPTOTIC, relative, run_engine_to_end
from validate.worlds import ours
from validate.worlds.conformance import Beside, error_of
from validate.worlds.described import DESCRIBED

MOST = 500                   # steps
SAME = 1e-3                  # of an error: bodies that touch begin a micrometre apart from those of the scene
OTHER_MODEL = {("incline", MUJOCO)}      # the scene's block is a ball there
JUDGED = [(name, product) for name, one in DESCRIBED.items() if not one.shown for product in BUILDERS
          if product.installed() and not product.world.refuses(one.model(one.scene.parameters))]
HINGED = {("pendulum", MUJOCO), ("rope", MUJOCO)}    # hinges in the scenes; the rods of their Models are soft
CHOSEN = [(name, runner) for name, one in DESCRIBED.items() if not one.shown for runner in one.scene.engine_runners
          if not runner.who.variant and (name, runner.who.product) in JUDGED
          and (name, runner.who.product) not in HINGED]


def errors(name, product, most=MOST):
    """(number of steps, error) of a world built from the Model, and the truth."""
    one = DESCRIBED[name]
    p, steps = one.scene.parameters, max(n for n in one.scene.steps if n <= most)
    truth = np.array(one.scene.truth(p, one.scene.duration), float)
    return steps, error_of(product, one, p, truth, steps), truth


@pytest.mark.parametrize(("name", "runner"), CHOSEN, ids=[f"{name}-{runner.label}" for name, runner in CHOSEN])
def test_a_model_errs_by_default_as_with_the_settings_of_its_scene(name, runner):
    scene = DESCRIBED[name].scene
    steps, error, truth = errors(name, runner.who.product)
    limit = runner.largest_error(scene.parameters, scene.duration / steps)
    assert error <= limit or limit >= ASYMPTOTIC
    if (name, runner.who.product) not in OTHER_MODEL:
        chosen = relative(run_engine_to_end(scene, runner.who, scene.parameters, steps).observed, truth)
        assert error == pytest.approx(chosen, rel=SAME)


@pytest.mark.parametrize("name", ["linear_drag", "oscillator", "spring_net"])
def test_mujoco_is_of_order_four_where_nothing_touches(name):
    """Also with springs and with loads, which count in every stage of a step."""
    if not MUJOCO.installed():
        pytest.skip(f"MuJoCo is not installed: {MUJOCO.remedy}")
    _, coarse, _ = errors(name, MUJOCO, 200)
    _, fine, _ = errors(name, MUJOCO, 500)
    assert np.log(coarse / fine) / np.log(500 / 200) > 3.5


def test_each_engine_runs_most_scenes():
    counts = {product.name: sum(not product.world.refuses(one.model(one.scene.parameters))
                                for one in DESCRIBED.values()) for product in BUILDERS if product.installed()}
    for name, most in {"pymunk": 24, "pybullet": 23, "mujoco": 20, "pyb2d3": 24, "rapier3d": 27}.items():
        assert counts.pop(name, most) == most
    assert all(count >= 15 for count in counts.values())                 # of an engine that is new


# ---------------------------------------------------------------------------------------------- our loop

OURS = Beside("our loop", ours.refuses, ours.build)


def test_our_loop_runs_every_scene():
    assert not any(ours.refuses(one.model(one.scene.parameters)) for one in DESCRIBED.values())


@pytest.mark.parametrize(("name", "order"), [("throw", 1), ("asymmetric_top", 2), ("heavy_top", 2)])
def test_our_loop_runs_the_scenes_in_space_with_the_order_of_its_parts(name, order):
    """Bodies turn by a splitting, and joints are RATTLE: both are of order 2.  Gravity alone is symplectic Euler."""
    one = DESCRIBED[name]
    p, steps = one.scene.parameters, [n for n in one.scene.steps if n <= 1000][-2:]
    truth = np.array(one.scene.truth(p, one.scene.duration), float)
    coarse, fine = (error_of(OURS, one, p, truth, n) for n in steps)
    assert np.log(coarse / fine) / np.log(steps[1] / steps[0]) == pytest.approx(order, abs=0.2)
    assert fine < 0.1
