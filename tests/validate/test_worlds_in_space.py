"""A mixed machine in space in our loop and in two engines that share nothing with it but the Model."""

import numpy as np
import pytest

from solutions.support.model import WORLD, BallJoint, Body, Distance, Hinge, Spring, Weld, can_move, make_model
from solutions.support.shapes import Ball, Box, Capsule, HalfSpace
from validate.engines.products import MUJOCO, PYBULLET, RAPIER
from validate.subject import modules
from validate.worlds import ours

G = 9.81                     # [m/s²]
DOWN = (0.0, 0.0, -G)
GROUND = Body((0.0, 0.0, 0.0), shape=HalfSpace((0.0, 0.0, 1.0)), mu=1.0, e=1.0)


def about(axis, angle):
    """Return the unit quaternion of a turn by an angle [rad] about an axis."""
    axis = np.array(axis) / np.linalg.norm(axis)
    return (np.cos(0.5 * angle), *(np.sin(0.5 * angle) * axis))


def mixed_machine():
    """A ball rolls askew down a ramp into dominoes; a box lands on a see-saw that carries a ball; a capsule lies on a
    crate that a spring pulls; a bob on a ball joint swings in a cone and into a post.
    """
    slope = 0.35
    along, n = np.array([np.cos(slope), 0.0, -np.sin(slope)]), np.array([np.sin(slope), 0.0, np.cos(slope)])
    ramp = np.array([-1.75, 0.0, 0.45])
    bodies = [
        GROUND, Body(tuple(ramp), shape=Box((0.6, 0.4, 0.03)), mu=1.0, e=1.0, q=about((0.0, 1.0, 0.0), slope)),
        Body(tuple(ramp - 0.35 * along + 0.11 * n + (0.0, -0.1, 0.0)), 1.0, Ball(0.08), 0.6, v=(0.0, 0.15, 0.0)),
        *[Body((-0.8 + 0.16 * k, 0.0, 0.15), 0.3, Box((0.025, 0.1, 0.15)), 0.4) for k in range(3)],
        Body((0.0, 1.0, 0.1), 0.8, Box((0.2, 0.15, 0.1)), 0.3),
        Body((0.02, 1.01, 0.26), 0.3, Capsule(0.1, 0.06), 0.5, q=about((0.0, 0.0, 1.0), 0.5)),
        Body((1.5, 0.0, 0.3), 0.8, Box((0.6, 0.15, 0.02)), 0.7),
        Body((1.05, 0.02, 0.38), 0.2, Ball(0.06), 0.7),
        Body((1.95, -0.03, 0.75), 1.5, Box((0.1, 0.09, 0.08)), 0.7, q=about((0.0, 0.0, 1.0), 0.3)),
        Body((1.0, 1.5, 1.0), 0.6, Ball(0.1), 0.4, v=(0.0, -0.5, 0.0), omega=(-0.625, 0.0, -0.625)),  # about its joint
        Body((0.62, 1.35, 0.5), 0.5, Box((0.05, 0.06, 0.5)), 0.5)]
    joints = [Hinge(8, WORLD, (1.5, 0.0, 0.3), (0.0, 1.0, 0.0)), BallJoint(11, WORLD, (0.6, 1.5, 1.4))]
    return make_model(bodies, DOWN, joints, [Spring(6, WORLD, (0.2, 0.05, 0.0), (1.0, 1.2, 0.1), 0.5, 60.0, 1.0)])


def history(world, steps, every):
    """Return the places (k, n, 3) of all bodies, after each `every` steps, and close the world."""
    found = []
    for k in range(1, steps + 1):
        world.step()
        if k % every == 0:
            found.append(world.state().x)
    world.close()
    return np.array(found)


def farthest(one, other, model):
    """Return the largest distance (k,) [m] of any centre that can move."""
    free = np.array([can_move(body) for body in model.bodies])
    return np.max(np.linalg.norm(one - other, axis=2)[:, free], axis=1)


@pytest.mark.long
def test_a_mixed_machine_moves_alike_in_our_loop_and_in_engines():
    """For 0.3 s.  Two codes of order 1 that fall are up to g T dt apart; MuJoCo's and Rapier's contacts are
    soft besides."""
    model, T, rate = mixed_machine(), 0.3, 200
    seen = history(ours.build(model, 1.0 / rate), round(T * rate), round(T * rate))
    soft = G * T / rate + 0.02                               # 0.02: measured, 19 mm of MuJoCo
    for product, most in ((PYBULLET, G * T / rate), (MUJOCO, soft), (RAPIER, soft)):
        if product.installed():
            other = history(product.world.build(model, 1.0 / 4000.0), 1200, 1200)
            assert farthest(seen, other, model)[-1] < most, product.name


# ---------------------------------------------------------------------------------------------- forces as results

def test_our_loop_tells_the_forces_of_contacts_and_joints_in_space():
    model = make_model([GROUND, Body((0.0, 0.0, 0.3), 2.0, Box((0.4, 0.5, 0.3)), mu=0.5)], DOWN)
    world = ours.build(model, 1e-3, sweeps=1000, settled=1e-12)
    for _ in range(20):
        world.step()
    on_box = sum((push.F if push.a == 1 else -push.F for push in world.pushes()), np.zeros(3))
    assert on_box == pytest.approx((0.0, 0.0, 2.0 * G), abs=1e-6)
    assert {push.joint for push in world.pushes()} == {None}


@pytest.mark.parametrize("joint", [
    Weld(0, WORLD, (-0.5, 0.0, 0.0)), Hinge(0, WORLD, (-0.5, 0.0, 0.0), (0.0, 0.0, 1.0)),
    BallJoint(0, WORLD, (0.0, 0.0, 0.5)), Distance(0, WORLD, (0.0, 0.0, 0.1), (0.0, 0.0, 1.0))],
    ids=lambda joint: type(joint).__name__)
def test_each_joint_in_space_carries_the_weight_of_what_hangs_on_it(joint):
    world = ours.build(make_model([Body((0.0, 0.0, 0.0), 2.0, Box((0.1, 0.2, 0.1)))], DOWN, [joint]), 1e-3)
    world.step()
    assert {(push.a, push.b, push.joint) for push in world.pushes()} == {(0, WORLD, 0)}
    assert sum(push.F for push in world.pushes()) == pytest.approx((0.0, 0.0, 2.0 * G), abs=1e-8)


def test_a_hinge_in_space_carries_a_quarter_of_a_rod_that_is_let_go_level():
    rod = Body((0.5, 0.0, 0.0), 2.0, Box((0.5, 1e-3, 1e-3)))
    world = ours.build(make_model([rod], DOWN, [Hinge(0, WORLD, (0.0, 0.0, 0.0), (0.0, 1.0, 0.0))]), 1e-4)
    world.step()
    assert sum(push.F for push in world.pushes()) == pytest.approx((0.0, 0.0, 0.5 * G), abs=1e-3)


def test_a_body_on_a_hinge_that_is_moved_out_of_the_floor_stays_at_rest():
    """The hinge was left open by 3 µm, and closing it gave velocities of 5 mm/s: its two points move no body along it.
    """
    box = Body((0.0, 0.0, 0.17), 1.0, Box((0.3, 0.2, 0.1)), q=about((0.0, 1.0, 0.0), 0.4))
    hinge = Hinge(1, WORLD, (-0.2, 0.1, 0.2), (0.6, 0.64, 0.48))
    world = ours.build(make_model([GROUND, box], (0.0, 0.0, 0.0), [hinge]), 0.01)
    for _ in range(30):
        world.step()
    state = world.state()
    assert np.max(np.abs(state.x[1] - box.x)) > 0.01                       # it was moved
    assert np.max(np.abs(state.v)) <= 1e-9 and np.max(np.abs(state.omega)) <= 1e-9


# ---------------------------------------------------------------------------------------------- compiled

@pytest.mark.long
@pytest.mark.xdist_group("compiled simulator")
def test_our_compiled_loop_in_space_runs_every_part_as_the_plain_one_does():
    if not modules.can_compile():
        pytest.skip("numba has no wheel for this machine")
    ball = Body((0.0, 0.0, 0.3), 1.0, Ball(0.2), e=0.5)
    rod = Distance(0, WORLD, (0.0, 0.0, 0.0), (0.5, 0.0, 0.8))
    hinge = Hinge(0, WORLD, (0.5, 0.0, 0.8), (0.6, 0.8, 0.0))
    free = ball._replace(shape=None, inertia=(0.1, 0.2, 0.25), omega=(1.0, 2.0, 0.5))
    for model in (mixed_machine(), make_model([ball, GROUND], DOWN), make_model([free], DOWN, [hinge]),
                  make_model([ball._replace(mu=0.5), GROUND], DOWN, [rod]), make_model([free], DOWN, [rod]),
                  make_model([ball._replace(v=(0.0, 0.0, -300.0)), GROUND], DOWN)):
        worlds = [ours.build(model, 2e-3, compiled=kind) for kind in (False, True)]
        for _ in range(60):
            for world in worlds:
                world.step()
        plain, compiled = (world.state() for world in worlds)
        assert compiled.x == pytest.approx(plain.x, abs=1e-9)
        assert compiled.q == pytest.approx(plain.q, abs=1e-9)
