"""Live scenes of points: a net that is pulled, a rope that hangs from the pointer, an arm that follows it.

The last part is about all live scenes but those of a Model.
"""

import re

import numpy as np
import pytest

from solutions import springs
from solutions.checks import BadInput
from solutions.given.pbd import make_constraint_network
from solutions.support.chains import make_arm_2d
from validate.notebook.live import FILM_ONLY, live, running
from validate.notebook.live.canvas import drawn
from validate.notebook.live.files import sentence
from validate.notebook.live.hand import HERTZ, pulled_point
from validate.notebook.live.kinds import BallOnSpring, Bucket, Hulls
from validate.notebook.live.points import FASTEST, Arm, Network
from validate.notebook.live.solids import Block, Brick, Pendulum
from validate.subject.generate import stub
from validate.subject.modules import SOLUTIONS

from .conftest import begun

DOWN = np.array((0.0, -9.81))
ROUND_OFF = 1e-9             # of energies of some joules after some hundred steps [J]


def ran(scene, steps):
    for _ in range(steps):
        scene.step()
        scene.remember()
    return scene


def net(folder=SOLUTIONS, dt=1 / 240, k_v=0.0, **settings):
    """A net of 5 × 5 nodes that hangs at two corners, as in notebook 2."""
    row, col = np.divmod(np.arange(25), 5)
    x = 0.1 * np.stack((col, -row), axis=1)
    pairs = springs.grid_pairs(5, 5, springs.STRUCTURAL + springs.SHEAR)
    network = springs.make_spring_network(x, 0.02, (0, 4), pairs, 100.0, 0.3, DOWN, np.zeros(2), k_v)
    return Network(network, x, folder, dt=dt, **settings)


def rope(folder=SOLUTIONS, links=10, sweeps=10, dt=1 / 60, gravity=DOWN):
    """A rope of 10 cm per link, straight below its first point, which is held."""
    x = np.stack((np.zeros(links + 1), -0.1 * np.arange(links + 1.0)), axis=1)
    pairs = [(k, k + 1) for k in range(links)]
    return Network(make_constraint_network(x, 0.02, [0], pairs, 0.0, 1.0, gravity, sweeps), x, folder, dt=dt)


def arm(folder=SOLUTIONS, damping=1.0, **settings):
    """An arm with a reach of 2.1 m, and with the damping that keeps it calm out of reach."""
    lengths = np.array((1.0, 0.7, 0.4))
    return Arm(make_arm_2d(lengths, 0.15, damping, -np.inf, np.inf, 0.0, 0.0), None, folder, **settings)


SCENES = {"springs": net, "pbd": rope, "kinematics": arm}


# ---------------------------------------------------------------------------------------------- the hand

def weightless():
    """One point that nothing else moves."""
    network = springs.make_spring_network(np.zeros((1, 2)), 0.02, (), np.zeros((0, 2), int), 1.0, 0.0, (0.0, 0.0),
                                          (0.0, 0.0), 0.0)
    return Network(network, np.zeros((1, 2)), SOLUTIONS)


def test_the_hand_brings_a_point_to_the_pointer_and_its_work_is_the_energy_of_the_point():
    scene = weightless()
    scene.grab(0, (0.0, 0.0), (1.0, 0.5))
    highest = max(ran(scene, 1).energy() for _ in range(20))
    assert highest > 1e-3 and scene.energy() == pytest.approx(scene.expected(), abs=ROUND_OFF)
    ran(scene, 300)
    assert np.allclose(scene.now().x[0], (1.0, 0.5), atol=1e-6)
    assert scene.energy() == pytest.approx(scene.expected(), abs=ROUND_OFF)


@pytest.mark.parametrize("dt", [1 / 480, 1 / 60, 1 / 15])
def test_a_light_point_never_gets_faster_than_a_spring_of_that_length_allows_and_an_explicit_one_explodes(dt):
    """All energy of the spring would move the mass that the hand feels at r ω."""
    m, felt, rate = 0.02, 1.0, 2.0 * np.pi * HERTZ

    def explicit(target, dt, x, v, m, felt):
        return v - dt / m * felt * (rate * rate * (x - target) + 2.0 * rate * v), 0.0

    def fastest(pull):
        x, v, found = np.array((0.1, 0.0)), np.zeros(2), 0.0
        for _ in range(100):
            v, _ = pull(np.zeros(2), dt, x, v, m, felt)
            x = x + dt * v
            found = max(found, np.hypot(*v))
            if found > 1e6:
                break
        return found
    assert fastest(pulled_point) <= 0.1 * rate
    assert (fastest(explicit) > 1e6) == (dt > 2.0 * m / (felt * 2.0 * rate))


def pulled_by(folder, force):
    """Where a node of the net is after a learner's hand has pulled it aside for two seconds (2,) [m]."""
    text = (SOLUTIONS / "springs.py").read_text()
    start = text.index("    ### BEGIN SOLUTION 2.14")
    (folder / "integrators.py").write_text((SOLUTIONS / "integrators.py").read_text())
    (folder / "springs.py").write_text(text[:start] + f"    {force}\n")
    scene = net(folder)
    k = int(np.flatnonzero(scene.free)[0])
    scene.grab(k, (0.0, 0.0), scene.now().x[k] + (0.02, 0.01))
    return ran(scene, round(2.0 / scene.tuning.dt)).now().x[k]


def test_the_hand_of_a_net_is_the_learners_and_a_given_one_until_it_is_written(tmp_path):
    calm = pulled_by(tmp_path, "return -(k * (x - target + dt * v) + c * v) / (1.0 + dt * (c + dt * k) / m)")
    assert np.allclose(pulled_by(tmp_path, "raise NotImplementedError('2.14')"), calm, rtol=0.0, atol=1e-9)
    with np.errstate(all="ignore"), pytest.raises(ArithmeticError, match="not finite"):
        pulled_by(tmp_path, "return -(k * (x - target) + c * v)")
    with pytest.raises(TypeError, match="force of the hand"):
        pulled_by(tmp_path, "return np.zeros(3)")


def test_a_fixed_point_goes_to_the_pointer_no_faster_than_the_hand_may_and_stays():
    scene = rope()
    scene.grab(0, (0.0, 0.0), (1.0, 0.2))
    before = scene.now().x[0]
    while np.hypot(*(before - (1.0, 0.2))) > 1e-9:
        now = ran(scene, 1).now().x[0]
        assert np.hypot(*(now - before)) <= FASTEST * scene.tuning.dt * (1.0 + 1e-12)
        before = now
        assert scene.t < 1.0
    scene.grip = None
    ran(scene, 20)
    assert np.allclose(scene.now().x[0], (1.0, 0.2), atol=1e-9)


# ---------------------------------------------------------------------------------------------- ropes and nets

def test_a_rope_that_is_carried_keeps_its_length_within_the_error_of_its_sweeps():
    """More sweeps leave a smaller error: PBD's convergence, and not the hand, sets it."""
    errors = []
    for sweeps in (5, 50):
        scene = rope(sweeps=sweeps)
        scene.grab(0, (0.0, 0.0), (0.5, 0.0))
        ran(scene, 60)
        errors.append(scene.overlap())
    assert errors[1] < 0.2 * errors[0] < 0.2 * 0.1


def test_a_rope_that_was_let_go_loses_energy_and_comes_to_hang_below_its_hook():
    scene = rope(links=4, sweeps=30)
    scene.grab(4, (0.0, 0.0), (0.3, -0.2))
    ran(scene, 60)
    scene.grip = None
    for _ in range(60):
        ran(scene, 1)
        assert scene.energy() <= scene.expected() + ROUND_OFF
    ran(scene, 2000)
    assert np.max(np.abs(scene.now().x[:, 0])) < 0.02
    assert scene.now().x[4, 1] == pytest.approx(-0.4, abs=0.005)


def test_a_net_that_is_pulled_far_returns_and_a_step_that_is_too_long_is_one_sentence():
    """The damper of 2.9 balances the gain of its step while k_d/k > dt/2."""
    scene = net()
    scene.grab(22, (0.0, 0.0), (0.5, -0.8))
    ran(scene, 60)
    assert scene.overlap() > 0.02                                  # it is stretched
    scene.grip = None
    assert ran(scene, 120).energy() < scene.expected()
    scene.set(dt=1 / 40)
    with pytest.raises(ArithmeticError) as error, np.errstate(all="ignore"):
        ran(scene, 2000)
    assert re.fullmatch(r"✗ ArithmeticError: [xv] of point \d+ is not finite at t = [\d.]+ s\.",
                        sentence(error.value, SOLUTIONS))


def test_a_net_that_hangs_carries_its_weight_in_its_springs():
    """At rest the springs at the two nails pull up with the weight of all free nodes."""
    scene = ran(net(k_v=0.1), 1000)
    x, network = scene.state.x, scene.now_network
    pull = sum((springs.spring_forces(x, 0.0 * x, network)[k] for k in (0, 4)), np.zeros(2))
    assert -pull[1] == pytest.approx(23 * 0.02 * 9.81, rel=1e-3) and abs(pull[0]) < 1e-3


def test_settings_of_a_net_change_its_motion_and_leave_the_points_where_they_are():
    scene = ran(net(), 50)
    before = scene.state
    scene.set(k=2.0)
    assert scene.state is before and scene.now_network.k[0] == 200.0
    for change in ({"k": 0.0}, {"dt": -1.0}, {"g": np.nan}):
        with pytest.raises(BadInput):
            scene.set(**change)
    assert scene.tuning.k == 2.0


# ---------------------------------------------------------------------------------------------- the arm

@pytest.mark.parametrize("target", [(0.9, 1.1), (2.0, -2.0)])
def test_the_end_of_the_arm_comes_as_near_to_the_pointer_as_its_length_allows(target):
    scene = arm()
    scene.grab(4, (0.0, 0.0), target)
    ran(scene, 400)
    smallest = max(0.0, np.hypot(*target) - 2.1)
    assert scene.expected() == pytest.approx(smallest)
    assert scene.energy() == pytest.approx(smallest, abs=1e-3)
    assert np.allclose(scene.now().x[4], target)


def test_an_arm_that_folds_has_a_hole_around_its_base():
    lengths = np.array((1.0, 0.2))
    scene = Arm(make_arm_2d(lengths, 0.15, 0.3, -np.inf, np.inf, 0.0, 0.0), (0.3, 2.0), SOLUTIONS)
    scene.grab(3, (0.0, 0.0), (0.1, 0.0))
    assert ran(scene, 400).expected() == pytest.approx(0.7) and scene.energy() >= 0.7


def test_the_damping_is_a_slider_and_without_it_the_arm_flails_out_of_reach():
    def restless(**settings):
        scene = arm(**settings)
        scene.grab(4, (0.0, 0.0), (2.5, 0.0))
        ran(scene, 100)
        return max(np.max(np.abs(ran(scene, 1).state.theta - before)) for before in [scene.state.theta] * 20)
    assert restless() < 0.01 and restless(method="pseudo_inverse_step") > 0.5
    scene = arm()
    e, before = scene.energy(), scene.state.theta

    def moved(damping):
        scene.reset()
        scene.set(damping=damping)
        return np.linalg.norm(ran(scene, 1).state.theta - before)
    assert moved(2.0) <= e / (2.0 * 2.0) < moved(0.1) <= e / (2.0 * 0.1)        # no step is longer than |e|/(2λ)


# ---------------------------------------------------------------------------------------------- what all have

KINDS = {"integrators": BallOnSpring, "friction": Block, "inertia_tensors": Pendulum, "rotation": Brick,
         "collisions": Hulls, "sensitivities": Bucket}
EVERY = {**SCENES, **{lesson: lambda folder=SOLUTIONS, kind=kind: kind(folder) for lesson, kind in KINDS.items()}}
MOVED_BY = {                 # {lesson: a function of it that every step runs}
    "springs": "spring_forces", "pbd": "distance_sweep", "kinematics": "damped_step", "integrators": "euler_step",
    "friction": "sliding_step", "inertia_tensors": "combine", "rotation": "rigid_body_step", "collisions": "gjk",
    "sensitivities": "aim"}


@pytest.mark.parametrize("of", EVERY)
def test_a_save_is_followed_and_an_error_is_one_sentence_with_its_line(of, learner):
    scene, text = ran(EVERY[of](learner.folder), 5), (SOLUTIONS / f"{of}.py").read_text()
    for spoiled, said in ((stub(text), r"○ Not attempted yet: \d+\.\d+: \w+\."),
                          (begun(of, MOVED_BY[of], "1 / 0"),
                           rf"✗ ZeroDivisionError: division by zero \({of}\.py, line \d+, in {MOVED_BY[of]}\)\."),
                          (begun(of, MOVED_BY[of], "v = = 1"), rf"✗ .*{of}\.py cannot be loaded.*line.*")):
        t, before = scene.t, scene.state
        learner(of, spoiled)
        assert scene.follow()
        with pytest.raises((NotImplementedError, ZeroDivisionError, BadInput)) as error:
            scene.step()
        assert re.fullmatch(said, sentence(error.value, learner.folder))
        assert scene.t == t and scene.state is before
    learner(of, text)
    assert scene.follow() and ran(scene, 1).t > t


@pytest.mark.parametrize("of", EVERY)
def test_a_scene_that_is_set_back_goes_on_as_it_did_and_its_past_is_a_film(of):
    scene = EVERY[of]()
    scene.grab(int(np.flatnonzero(scene.moves)[-1]), (0.0, 0.0), (0.4, 0.1))
    ran(scene, 40)
    scene.grip = None
    ran(scene, 40)
    end, middle = scene.state, scene.past[-4].t
    scene.seek(middle)
    ran(scene, round((80 * scene.tuning.dt - middle) / scene.tuning.dt))
    assert all(np.array_equal(a, b) for a, b in zip(scene.state, end, strict=True))
    assert scene.bytes == sum(map(running.size_of_moment, scene.past)) > 0
    seconds, links, films = scene.pictures()
    assert seconds == pytest.approx(80 * scene.tuning.dt, abs=0.04)
    assert max(map(max, links)) < len(films["mine"][0])
    scene.reset()
    assert scene.t == 0.0 and scene.grip is None and scene.energy() == scene.origin


@pytest.mark.parametrize("of", EVERY)
def test_the_canvas_knows_every_point_and_what_can_be_taken(of):
    scene = EVERY[of]()
    found = drawn(scene, "x", 300, None)
    n, (left, right, low, high) = len(scene.now().x), found["view"]
    assert len(found["bodies"]) == n and [body["moves"] for body in found["bodies"]] == list(map(bool, scene.moves))
    assert all(0 <= k < n for link in found["links"] for k in link) and found["anywhere"] < n
    assert all(left < x < right and low < y < high for x, y in scene.now().x)
    for one in found["knobs"]:
        scene.set(**{one["key"]: scene.tuning._asdict()[one["key"]]})
        assert one["low"] <= one["value"] <= one["high"]


@pytest.mark.parametrize("of", EVERY)
def test_where_no_kernel_stays_it_is_a_film(of, monkeypatch):
    monkeypatch.setenv(FILM_ONLY, "film")
    monkeypatch.setenv("WORKBOOK_LESSONS", str(SOLUTIONS))
    monkeypatch.setattr("validate.notebook.live.FILM_SECONDS", 0.2)
    scene = EVERY[of]()
    if of in KINDS:
        shown = live(KINDS[of])
    else:
        shown = live(scene.arm) if of == "kinematics" else live(scene.network, start=scene.first.x)
    assert shown.data.count('<canvas data-picture="p') == 1


def test_what_cannot_be_live_is_refused_in_one_sentence():
    scene = rope()
    for arguments, said in ((([1],), "the model of a live scene"), ((scene.network,), "the start of a live network")):
        with pytest.raises(BadInput, match=said):
            live(*arguments)
    with pytest.raises(BadInput, match="the positions of a live network"):
        Network(scene.network, np.zeros((3, 2)), SOLUTIONS)
    with pytest.raises(BadInput, match="it has no juggling_step"):
        Network(scene.network, scene.first.x, SOLUTIONS, method="juggling_step").step()
    with pytest.raises(BadInput, match="the body to grab"):
        arm().grab(0, (0.0, 0.0), (1.0, 1.0))
