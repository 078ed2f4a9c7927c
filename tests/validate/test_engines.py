"""The engines' adapters do what the scenes say of them."""

import numpy as np
import pytest

from validate.engines.bullet import Bullet, Rigid
from validate.products import PYBULLET
from validate.subject import modules

needs_pybullet = pytest.mark.skipif(not PYBULLET.installed(), reason=f"pybullet is not installed: {PYBULLET.remedy}")
WITH_PYBULLET = [name for name in modules.scene_names()
                 if any(r.who.product == PYBULLET for r in modules.bind_scene(name).engine_runners)]


class SteppedError(Exception):
    """A world has made its first step."""


@needs_pybullet
@pytest.mark.parametrize(("begins", "expected"), [(True, (1.0, 1.0, 0.75)), (False, (2.5, 5.0, 7.5))])
def test_moments_count_in_the_first_step_of_a_world_that_begins(begins, expected):
    """Without `begin` the first step has the moments 2/5 m r² of the sphere."""
    bullet = Rigid(0.01, (0.0, 0.0, -9.81))
    body = bullet.body(1.0, (1.0, 2.0, 4.0), (0.0, 0.0, 1.0), (0.0,) * 3, True, v=(1.0, 2.0, 3.0),
                       shape=bullet.ball(1.0))
    if begins:
        bullet.begin()
    assert bullet.position(body) == (0.0, 0.0, 1.0) and bullet.velocity(body) == (1.0, 2.0, 3.0)
    bullet.pb.applyExternalTorque(body, -1, [1.0, 2.0, 3.0], bullet.pb.WORLD_FRAME)
    bullet.step()
    omega, v = bullet.omega(body), bullet.velocity(body)
    bullet.close()
    assert np.allclose(omega, 0.01 * np.array(expected), rtol=1e-12)
    assert np.allclose(v, (1.0, 2.0, 3.0 - 0.0981), rtol=1e-12)


def waiting_in(engine, p, dt):
    """Return how many bodies wait for their moments at the first step of this engine's world; 0 without any step."""
    try:
        run = engine.make(p, dt)
        run.step()
        run.read()
        run.close()
    except SteppedError as stepped:
        return stepped.args[0]
    return 0


@needs_pybullet
@pytest.mark.parametrize("name", [name for name in WITH_PYBULLET if name != "piles"])     # has an adapter of its own
def test_in_no_scene_a_moment_of_inertia_counts_from_the_second_step_on(name, monkeypatch):
    def first_step(bullet):
        bullet.close()
        raise SteppedError(len(bullet.waiting))
    monkeypatch.setattr(Bullet, "step", first_step)
    scene = modules.bind_scene(name)
    found = {(runner.label, case): waiting_in(runner.who, p, scene.duration / scene.steps[0])
             for runner in scene.engine_runners if runner.who.product == PYBULLET
             for case, p in scene.cases.items() if runner.supports is None or runner.supports(p)}
    assert found and not any(found.values()), found
