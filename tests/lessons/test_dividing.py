"""Fast bodies do not pass through thin ones: a step in which they would is divided where they first touch."""

import numpy as np
import pytest

from solutions.given.compose import compose, run_parts, state_of
from solutions.given.dividing import divided_step, pose_within, whole_step
from solutions.support.model import WORLD, Ball, Body, Box, Capsule, HalfSpace, Hinge, Polygon, make_model
from validate.subject import modules
from validate.worlds import ours

DT = 1.0 / 60.0                                # [s]
TRIANGLE = Polygon(((-0.1, -0.1), (0.2, -0.1), (-0.1, 0.2)))
SHAPES = Ball(0.1), Box((0.1, 0.1)), Capsule(0.1, 0.05), TRIANGLE


def wall(d, x=0.0, half=0.01, high=1.0):
    """Return a thin wall across the first axis that nothing moves."""
    return Body((x,) + (0.0,) * (d - 1), shape=Box((half,) + (high,) * (d - 1)), mu=1.0, e=1.0)


def states(model, steps, **changed):
    """Return the State after each step."""
    loop = compose(model)
    loop, state, found = loop._replace(**changed), loop.state, []
    for k in range(steps):
        state = run_parts(loop, k * DT, state, DT, 1)
        found.append(state_of(loop, state))
    return found


def test_steps_are_divided_only_where_something_can_touch():
    ball = Body((-1.0, 0.0), 1.0, Ball(0.1))
    assert compose(make_model([ball], (0.0, 0.0))).step.step is whole_step
    assert compose(make_model([ball, wall(2)], (0.0, 0.0))).step.step is divided_step


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: type(shape).__name__)
def test_a_body_of_a_hundred_metres_per_second_stops_at_a_wall_of_two_centimetres(shape):
    model = make_model([wall(2), Body((-1.0, 0.05), 1.0, shape, v=(100.0, 0.0))], (0.0, 0.0))
    assert states(model, 2, step=compose(model).step._replace(step=whole_step))[-1].x[1, 0] > 0.5      # it would pass
    for s in states(model, 2):
        assert s.x[1, 0] < -0.02


@pytest.mark.parametrize("e", [0.5, 1.0])
@pytest.mark.parametrize("d", [2, 3])
def test_a_fast_ball_bounces_off_a_thin_wall_at_the_very_time_of_its_impact(e, d):
    rest, v = (0.0,) * (d - 1), 100.0
    model = make_model([wall(d), Body((-1.0, *rest), 1.0, Ball(0.1), e=e, v=(v, *rest))], (0.0,) * d)
    s = states(model, 1)[0]
    hits = (1.0 - 0.01 - 0.1) / v
    assert s.v[1, 0] == pytest.approx(-e * v, rel=1e-12)
    assert s.x[1, 0] == pytest.approx(-0.11 - e * v * (DT - hits), abs=1e-9)


@pytest.mark.parametrize("e", [0.5, 1.0])
@pytest.mark.parametrize("g", [-50.0, 9.81, 50.0])
@pytest.mark.parametrize("d", [2, 3])
def test_a_fast_ball_bounces_off_a_thin_wall_while_a_force_acts(d, g, e):
    """The part that is to end where they touch is run anew and gains less speed, so it leaves a gap open.

    As in every step, the force of the part after the impact acts before the impulse: first order.
    """
    rest, v = (0.0,) * (d - 1), 100.0
    model = make_model([wall(d), Body((-1.0, *rest), 1.0, Ball(0.1), e=e, v=(v, *rest))], (g, *rest))
    s = states(model, 1)[0]
    hits = (1.0 - 0.01 - 0.1) / v
    assert s.v[1, 0] == pytest.approx(-e * (v + g * hits) + g * (DT - hits), abs=2.0 * abs(g) * DT)
    assert s.x[1, 0] == pytest.approx(-0.11 - e * v * (DT - hits), abs=2.0 * abs(g) * DT**2)


def test_what_flies_past_a_corner_is_not_stopped():
    """It comes within a millimetre of the wall's end, and its swept box touches the wall."""
    way = np.array([1.0, 1.0]) / np.sqrt(2.0)
    beside = np.array([-1.0, 1.0]) / np.sqrt(2.0) * 0.101              # from the corner, across the way
    corner = np.array([-0.01, 1.0])
    for offset, passes in ((beside, True), (0.9 * beside, False)):
        start = corner + offset - 1.0 * way
        s = states(make_model([wall(2), Body(tuple(start), 1.0, Ball(0.1), v=tuple(150.0 * way))], (0.0, 0.0)), 1)[0]
        straight = np.max(np.abs(s.v[1] - 150.0 * way)) < 1e-9
        assert straight == passes


@pytest.mark.parametrize("d", [2, 3])
def test_two_bullets_that_meet_within_a_step_exchange_their_velocities(d):
    rest = (0.0,) * (d - 1)
    balls = [Body((sign * 1.0, *rest), 1.0, Ball(0.05), e=1.0, v=(-sign * 120.0, *rest)) for sign in (-1.0, 1.0)]
    s = states(make_model(balls, (0.0,) * d), 1)[0]
    assert s.v[:, 0] == pytest.approx([-120.0, 120.0], rel=1e-12)
    assert s.x[:, 0] == pytest.approx([-0.05 - 120.0 * (DT - 0.95 / 120.0), 0.05 + 120.0 * (DT - 0.95 / 120.0)],
                                      abs=1e-9)


def test_a_ball_that_bounces_between_two_walls_several_times_in_a_step_stays_between_them():
    model = make_model([wall(2, -0.5), wall(2, 0.5), Body((0.0, 0.0), 1.0, Ball(0.1), e=1.0, v=(150.0, 0.0))],
                       (0.0, 0.0))
    for s in states(model, 5):
        assert abs(s.x[2, 0]) < 0.39 + 1e-6
        assert abs(s.v[2, 0]) == pytest.approx(150.0, rel=1e-12)


def test_a_rod_that_spins_fast_on_a_hinge_does_not_turn_through_a_post():
    """Its tip would move by two metres, and past the post, in a step."""
    rod = Body((0.0, 0.0), 1.0, Box((1.0, 0.02)), omega=120.0)
    post = Body((0.0, 0.8), shape=Ball(0.03))
    s = states(make_model([rod, post], (0.0, 0.0), [Hinge(0, WORLD, (0.0, 0.0))]), 1)[0]
    assert 1.2 < s.q[0] < 0.5 * np.pi
    assert s.x[0] == pytest.approx((0.0, 0.0), abs=1e-9)               # and the hinge holds
    assert abs(s.omega[0]) < 1e-3 * 120.0                              # sweeps end at a thousandth


@pytest.mark.parametrize("spin", [(1.9, 17.0, -48.0), (-40.3, -108.6, -127.4), (7.1, 95.0, 120.0), (0.0, 300.0, 0.0)])
def test_a_fast_capsule_that_tumbles_does_not_pass_a_thin_plate_in_space(spin):
    """It turns by one to three radians in a step, and its spin changes: its axis of symmetry goes round."""
    for high, v in ((0.96, -192.0), (1.03, -192.0), (1.14, -135.0), (1.2, -110.0)):
        plate = Body((0.0, 0.0, 0.0), shape=Box((2.0, 2.0, 0.01)), mu=0.3)
        capsule = Body((0.0, 0.0, high), 1.0, Capsule(0.3, 0.02), mu=0.3, v=(0.0, 0.0, v), omega=spin)
        for s in states(make_model([plate, capsule], (0.0, 0.0, 0.0)), 2):
            assert s.x[1, 2] > 0.0


def test_the_pose_within_a_step_is_where_a_step_of_that_length_ends():
    rng, I = np.random.default_rng(3), (0.2, 0.5, 0.6)
    body = Body((0.0, 0.0, 0.0), 1.0, Ball(0.1), inertia=I, v=tuple(rng.normal(size=3)), omega=(40.0, -70.0, 20.0))
    loop = compose(make_model([body], (0.0, 0.0, 0.0)))
    after = run_parts(loop, 0.0, loop.state, DT, 1)
    for share in (0.0, 0.1, 0.5, 0.93, 1.0):
        x, q = pose_within(loop.state, after, share, DT, loop.p.inv_inertia)
        there = run_parts(loop, 0.0, loop.state, share * DT, 1) if share > 0.0 else loop.state
        assert x[0] == pytest.approx(there.x[0], abs=1e-13)
        assert q[0] == pytest.approx(there.q[0], abs=1e-12)


def test_a_fast_body_that_falls_on_a_floor_does_not_sink_in():
    floor = Body((0.0, 0.0), shape=HalfSpace((0.0, 1.0)), mu=1.0, e=1.0)
    for s in states(make_model([floor, Body((0.0, 1.0), 1.0, Box((0.1, 0.05)), mu=0.5, v=(3.0, -80.0))],
                               (0.0, -9.81)), 3):
        assert s.x[1, 1] > 0.049


def test_a_plane_that_a_fast_body_leaves_hides_no_other_impact():
    floor = Body((0.0, 0.0), shape=HalfSpace((0.0, 1.0)), mu=1.0, e=1.0)
    lid = Body((0.0, 1.0), shape=Box((1.0, 0.01)), mu=1.0, e=1.0)
    s = states(make_model([floor, lid, Body((0.0, 0.3), 1.0, Ball(0.1), v=(0.0, 100.0))], (0.0, 0.0)), 1)[0]
    assert s.x[2, 1] == pytest.approx(0.89, abs=1e-9)


@pytest.mark.skipif(not modules.can_compile(), reason="numba has no wheel for this machine")
@pytest.mark.xdist_group("compiled simulator")
@pytest.mark.parametrize("d", [2, pytest.param(3, marks=pytest.mark.long)])
def test_a_compiled_loop_divides_its_steps_as_the_plain_one_does(d):
    """Two fast balls, and a wall and a post that nothing moves; parts of a step are compiled when they are needed."""
    still = (0.0,) * (d - 1)
    post = Body((0.5, 3.0, *still[1:]), shape=Ball(0.2), mu=1.0, e=1.0)
    fast = [Body((-1.0, y, *still[1:]), 1.0, Ball(0.1), e=1.0, v=(100.0, *still)) for y in (0.0, 3.0)]
    model, ends = make_model([wall(d), post, *fast], (0.0,) * d), []
    for compiled in (False, True):
        world = ours.build(model, DT, compiled=compiled)
        for _ in range(3):
            world.step()
        ends.append(world.state())
    assert np.max(ends[0].x[2:, 0]) < 0.4
    for plain, quick in zip(*ends, strict=True):
        assert quick == pytest.approx(plain, abs=1e-9)
