"""Live scenes of a single function: the learner's function moves them, and a wrong one is seen beside the truth."""

import numpy as np
import pytest

from solutions.checks import BadInput
from solutions.support.quaternions import unrotate
from validate.notebook.live.kinds import HIT, BallOnSpring, Bucket, Hulls
from validate.notebook.live.solids import Block, Brick, Pendulum
from validate.subject.modules import SOLUTIONS

from .conftest import begun
from .test_live_points import ROUND_OFF, ran

# {kind: (steps, its largest departure from the truth [m], a line that spoils its function)}
# Euler's amplitude grows by (1 + (ω dt)²/2)^steps; the block stops up to |v| dt/2 later, with |v| = 3 m/s; the pendulum
# has the same step as its truth; the brick errs by (ω dt)² per step, and its error grows while it turns over
MISTAKES = {
    BallOnSpring: (60, 0.1, "dt = 1.3 * dt"),
    Block: (150, 0.0126, "p = p._replace(mu_k=0.9 * p.mu_k)"),
    Pendulum: (200, ROUND_OFF, "I = 0.9 * I"),
    Brick: (400, 0.02, "omega = 0.99 * omega"),
}


def departure(scene, steps):
    """The largest distance of a scene from the exact motion, over some steps [m]."""
    return max(ran(scene, 1).apart() for _ in range(steps))


@pytest.mark.parametrize("kind", MISTAKES)
def test_the_right_function_stays_near_the_exact_motion_and_a_wrong_one_that_is_saved_leaves_it(kind, learner):
    steps, most, mistake = MISTAKES[kind]
    assert departure(kind(learner.folder), steps) <= most
    scene = ran(kind(learner.folder), 1)
    learner(kind.lesson, begun(kind.lesson, kind.method, mistake))
    assert scene.follow() and departure(scene, steps) > 2.0 * most


def test_other_steps_move_the_ball_and_verlet_keeps_its_energy_where_eulers_grows():
    """Euler's factor per step is 1 + (ω dt)²; Verlet's error is bounded by a share of (ω dt)²/4."""
    euler, verlet = ran(BallOnSpring(SOLUTIONS), 600), BallOnSpring(SOLUTIONS, "verlet_step")
    z = euler.tuning.omega * euler.tuning.dt
    assert euler.energy() == pytest.approx((1.0 + z * z) ** 600 * euler.origin)
    assert all(abs(ran(verlet, 1).energy() / verlet.origin - 1.0) <= 0.25 * z * z for _ in range(600))


@pytest.mark.parametrize("zeta", [0.0, 0.3])
def test_the_exact_motion_of_the_ball_is_the_limit_of_short_steps(zeta):
    scene = BallOnSpring(SOLUTIONS, "rk4_step")
    scene.set(dt=1 / 480, zeta=zeta)
    assert departure(scene, 480) < 1e-8


def test_the_hand_carries_the_ball_and_the_exact_motion_begins_where_it_is_let_go():
    scene = BallOnSpring(SOLUTIONS)
    scene.grab(1, (0.0, 0.0), (1.0, 0.5))
    ran(scene, 120)
    assert np.hypot(*(scene.now().x[1] - (1.0, 0.5))) < 0.02 and scene.apart() == 0.0
    scene.grip = None
    assert 0.0 < ran(scene, 5).apart() < 0.05


# ---------------------------------------------------------------------------------------------- lesson 3

def still(**settings):
    """A block at rest in the middle of the table."""
    scene = Block(SOLUTIONS, start=((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
    scene.set(**settings)
    return scene


def test_a_band_moves_the_block_only_beyond_the_limit_of_static_friction():
    for share, moves in ((0.98, False), (1.02, True)):
        scene = still()
        scene.grab(0, (0.0, 0.0), (share * 0.6 * 9.81 / 25.0, 0.0))
        ran(scene, 30)
        assert bool(scene.now().x[0, 0] > 0.0) == moves
        if not moves:
            assert scene.energy() == pytest.approx(share * scene.expected())
            assert np.allclose(scene.forces()[0, 2:], (-share * 0.6 * 9.81, 0.0))


@pytest.mark.parametrize(("tilt", "moves"), [(30.0, False), (32.0, True)])
def test_a_tilted_table_lets_the_block_go_beyond_the_arc_tangent_of_static_friction(tilt, moves):
    scene = ran(still(tilt=tilt), 30)
    assert bool(scene.now().x[0, 1] < 0.0) == moves and scene.engine_state is None


# ---------------------------------------------------------------------------------------------- lesson 4

def test_a_weight_that_moves_towards_the_nail_leaves_the_angular_momentum():
    scene = Pendulum(SOLUTIONS, start=(0.0, 2.0))
    scene.set(g=0.0)
    before = scene.true_moment() * scene.state.omega[0]
    scene.set(way=0.2)
    assert scene.true_moment() * scene.state.omega[0] == pytest.approx(before) and scene.state.omega[0] > 4.0
    assert ran(scene, 50).energy() == pytest.approx(scene.expected(), abs=ROUND_OFF)


def test_a_pendulum_swings_fastest_with_its_weight_at_27_centimetres():
    def crossing(way):
        scene = Pendulum(SOLUTIONS, start=(0.1, 0.0))
        scene.set(way=way)
        while scene.state.q[0] > 0.0:
            scene.step()
        return scene.t - scene.state.q[0] / scene.state.omega[0]
    assert crossing(0.272) < min(crossing(0.2), crossing(0.35))


def test_the_hand_turns_the_pendulum_to_the_pointer_and_its_work_is_the_energy():
    scene = Pendulum(SOLUTIONS)
    scene.grab(1, (0.0, 0.0), (0.9, 0.0))
    ran(scene, 240)
    assert np.hypot(*(scene.held_place(scene.grip) - (0.9, 0.0))) < 0.05
    assert scene.energy() == pytest.approx(scene.expected(), rel=1e-3)


# ---------------------------------------------------------------------------------------------- lesson 5

def test_the_brick_turns_over_about_its_middle_axis_and_not_about_the_others():
    def turned_over(omega):
        scene = Brick(SOLUTIONS, start=((1.0, 0.0, 0.0, 0.0), omega))
        k = int(np.argmax(omega))
        return min(unrotate(ran(scene, 1).state.q, scene.state.omega)[k] for _ in range(600)) < 0.0
    assert [turned_over(omega) for omega in ((3.0, 0.01, 0.01), (0.01, 3.0, -0.01), (0.01, 0.01, 3.0))] == [
        False, True, False]


def test_the_hand_brings_a_corner_of_the_brick_to_the_pointer():
    scene = Brick(SOLUTIONS, start=((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
    target = scene.now().x[7] + (0.05, 0.1)
    scene.grab(7, (0.0, 0.0), target)
    ran(scene, 600)
    assert np.hypot(*(scene.now().x[7] - target)) < 0.02
    assert np.linalg.norm(scene.state.omega) < 0.5


# ---------------------------------------------------------------------------------------------- lesson 6

def test_the_first_shape_follows_the_pointer_and_the_line_has_the_true_distance(learner):
    scene = Hulls(learner.folder)
    for target in ((-1.0, -0.8), (0.1, 0.2), (1.5, 0.7)):
        scene.grab(0, (0.1, 0.0), target)
        ran(scene, 60)
        assert np.allclose(scene.held_place(scene.grip), target) and scene.energy() == pytest.approx(scene.expected())
    learner("collisions", begun("collisions", "gjk", "return ball_contact(a[0], 0.0, b[0], 0.0)"))
    assert scene.follow() and ran(scene, 1).energy() > scene.expected() + 0.1


# ---------------------------------------------------------------------------------------------- lesson 12

def test_the_throw_follows_the_target_and_with_a_search_that_does_nothing_it_misses(learner):
    scene = Bucket(learner.folder)
    ran(scene, 1)
    for target in ((1.0, 1.0), (2.6, 0.4), (0.4, 1.8)):
        scene.grab(len(scene.bodies) - 1, (0.0, 0.0), target)
        ran(scene, 90)
        assert np.allclose(scene.state.target, target) and scene.energy() < 10.0 * HIT
    learner("sensitivities", begun("sensitivities", "aim", "return s, np.zeros(1)"))
    scene.grab(len(scene.bodies) - 1, (0.0, 0.0), (2.0, 0.5))
    assert scene.follow() and ran(scene, 60).energy() > 0.1


@pytest.mark.parametrize("target", [(0.3, -0.5), (4.0, 1.0), (4.0, -2.0)])
def test_a_target_beyond_floor_or_wall_stays_in_the_room_and_is_hit(target):
    scene = Bucket(SOLUTIONS)
    scene.grab(len(scene.bodies) - 1, (0.0, 0.0), target)
    ran(scene, 120)
    x, y = scene.state.target
    assert y > 0.05 and x < 3.0 + y * np.tan(np.radians(20.0)) and scene.energy() < 10.0 * HIT


# ---------------------------------------------------------------------------------------------- settings

def test_a_slider_refuses_what_it_does_not_have_and_keeps_its_value():
    scene = Block(SOLUTIONS)
    for change in ({"dt": 0.0}, {"dt": np.nan}, {"tilt": 61.0}, {"mu_s": -0.1}):
        with pytest.raises(BadInput):
            scene.set(**change)
    assert scene.tuning.dt == 1 / 120 and scene.tuning.mu_s == 0.6


def test_the_exact_motion_can_be_hidden_and_shown_again():
    scene = ran(BallOnSpring(SOLUTIONS), 10)
    scene.show_beside(False)
    assert ran(scene, 1).engine_state is None and scene.apart() == 0.0
    scene.show_beside(True)
    assert scene.apart() == 0.0 < ran(scene, 1).apart()
