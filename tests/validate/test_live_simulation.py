"""A live scene without its canvas: the hand, the past, the settings, and a learner's file that is saved again."""

import os
import re
import time

import numpy as np
import pytest

from solutions.checks import BadInput
from solutions.support.model import WORLD, Ball, Body, Box, Distance, HalfSpace, Hinge, make_model, model_energy
from validate.notebook.live import running
from validate.notebook.live.canvas import drawn
from validate.notebook.live.files import sentence
from validate.notebook.live.hand import HERTZ, Grip, offset, pulled
from validate.notebook.live.loops import LOOPS
from validate.notebook.live.simulation import Simulation, Tuning
from validate.subject.generate import stub
from validate.subject.modules import SOLUTIONS, lesson_names

FLOOR = Body((0.0, 0.0), shape=HalfSpace((0.0, 1.0)), mu=1.0, e=1.0)
DOWN = (0.0, -9.81)
ROUND_OFF = 1e-9             # of energies of some joules after some hundred steps [J]


def boxes(n=2):
    """A stack on a floor."""
    return make_model([FLOOR, *(Body((0.0, 0.1 + 0.2 * k), 1.0, Box((0.15, 0.1)), mu=0.5) for k in range(n))], DOWN)


def ran(scene, steps):
    for _ in range(steps):
        scene.step()
        scene.remember()
    return scene


@pytest.fixture
def learner(tmp_path):
    """A learner's folder with all lessons solved, and save(lesson, before, after), which edits a file in it."""
    for file in SOLUTIONS.glob("*.py"):
        (tmp_path / file.name).write_text(file.read_text())
    stamps = iter(range(1, 1000))

    def save(lesson, *edits):
        file = tmp_path / f"{lesson}.py"
        text = (SOLUTIONS / file.name).read_text()
        for before, after in edits:
            assert text.count(before) == 1
            text = text.replace(before, after)
        file.write_text(text)
        os.utime(file, ns=(0, time.time_ns() + next(stamps)))      # two saves within one tick of the clock
    save.folder = tmp_path
    return save


# ---------------------------------------------------------------------------------------------- the hand

def fastest_spin(pull, dt):
    """The largest angular velocity in three seconds of a light box that is held at its corner [rad/s]."""
    x, q, v, omega, fastest = np.array((-0.1, -0.08)), 0.0, np.zeros(2), 1.0, 0.0
    for _ in range(round(3.0 / dt)):
        v, omega = pull(dt, x, q, v, omega)
        x, q = x + dt * v, q + dt * omega
        fastest = max(fastest, abs(omega))
        if fastest > 1e6:
            break
    return fastest


@pytest.mark.parametrize("dt", [1 / 480, 1 / 120, 1 / 30, 1 / 15])
def test_the_hand_gives_no_energy_for_any_step_and_an_explicit_spring_explodes(dt):
    m, I, grip = 1.0, 0.0067, Grip(0, (0.1, 0.1), (0.0, 0.0))
    k, c = m * (2.0 * np.pi * HERTZ) ** 2, 4.0 * np.pi * HERTZ * m

    def explicit(dt, x, q, v, omega):
        r = offset(grip, q)
        across = np.array((-r[1], r[0]))
        F = -k * (x + r) - c * (v + omega * across)
        return v + dt * F / m, omega + dt * (across @ F) / I
    bound = np.sqrt((I * 1.0**2 + k * 0.02**2) / I)          # all energy of the start, as spin
    assert fastest_spin(lambda *now: pulled(grip, *now, 1.0 / m, 1.0 / I)[:2], dt) <= 1.05 * bound
    assert (fastest_spin(explicit, dt) > 10.0 * bound) == (dt > 1 / 200)


def test_the_work_of_the_hand_is_the_change_of_kinetic_energy():
    grip, v, omega = Grip(0, (0.1, -0.05), (1.0, 2.0)), np.array((0.3, -0.2)), 4.0
    v_new, omega_new, work = pulled(grip, 0.01, np.zeros(2), 0.3, v, omega, 0.5, 30.0)
    kinetic = lambda v, omega: 0.5 * v @ v / 0.5 + 0.5 * omega**2 / 30.0
    assert work == pytest.approx(kinetic(v_new, omega_new) - kinetic(v, omega), rel=1e-12)


def test_energy_is_that_at_the_start_plus_the_work_of_the_hand():
    """A body in flight, without contact: symplectic Euler in a uniform field loses ½ m g² dt per second of flight."""
    model = make_model([Body((0.0, 1.0), 2.0, Box((0.1, 0.1)))], (0.0, 0.0))
    scene = Simulation(model, SOLUTIONS, beside=False)
    scene.grab(0, (0.05, 0.0), (1.0, 1.5))
    ran(scene, 100)
    assert scene.energy() > 0.0 or scene.given != 0.0
    assert scene.energy() == pytest.approx(scene.expected(), abs=ROUND_OFF)


def test_the_hand_brings_a_body_to_the_pointer_in_both_worlds():
    model = make_model([Body((0.0, 1.0), 2.0, Box((0.1, 0.1)))], (0.0, 0.0))
    scene = Simulation(model, SOLUTIONS)
    scene.grab(0, (0.0, 0.0), (1.0, 1.5))
    ran(scene, 240)
    assert np.allclose(scene.now().x[0], (1.0, 1.5), atol=1e-3)
    assert np.allclose(scene.engine_state.x[0], (1.0, 1.5), atol=1e-3)


def test_a_body_that_is_let_go_flies_on():
    scene = Simulation(make_model([Body((0.0, 1.0), 1.0, Ball(0.1))], (0.0, 0.0)), SOLUTIONS, beside=False)
    scene.grab(0, (0.0, 0.0), (3.0, 1.0))
    ran(scene, 10)
    scene.grip = None
    v = scene.now().v[0].copy()
    ran(scene, 10)
    assert v[0] > 0.5 and np.array_equal(scene.now().v[0], v)


def test_what_nothing_moves_cannot_be_grabbed():
    scene = Simulation(boxes(), SOLUTIONS)
    for body in (0, 7, -1):
        with pytest.raises(BadInput, match="the body to grab"):
            scene.grab(body, (0.0, 0.0), (0.0, 0.0))


# ---------------------------------------------------------------------------------------------- the past

def test_a_scene_that_is_set_back_goes_on_as_it_did():
    scene = ran(Simulation(make_model([FLOOR, Body((0.0, 0.5), 1.0, Box((0.1, 0.1)), mu=0.3, e=0.4, v=(1.0, 0.0),
                                                    omega=2.0)], DOWN), SOLUTIONS), 120)
    middle, end, E, given = scene.past[15], scene.now(), scene.energy(), scene.given
    scene.seek(middle.t)
    assert scene.t == middle.t and len(scene.past) > 16                # the future is still there
    for _ in range(round((1.0 - middle.t) / scene.tuning.dt)):
        scene.step()
        scene.remember()
    assert all(np.array_equal(a, b) for a, b in zip(scene.now(), end, strict=True))
    assert (scene.energy(), scene.given) == (E, given)


def test_a_step_from_the_past_forgets_the_future():
    scene = ran(Simulation(boxes(), SOLUTIONS), 120)
    scene.seek(0.5)
    scene.step()
    assert scene.past[-1].t <= scene.t


def test_the_past_has_thirty_seconds_at_most(monkeypatch):
    monkeypatch.setattr(running, "SECONDS_KEPT", 0.5)
    scene = ran(Simulation(boxes(1), SOLUTIONS, beside=False), 180)
    assert 0.45 < scene.past[-1].t - scene.past[0].t <= 0.5 + 1e-9
    assert scene.bytes == sum(map(running.size_of_moment, scene.past))


def test_the_past_of_many_bodies_has_a_limit_in_bytes(monkeypatch):
    monkeypatch.setattr(running, "MOST_KEPT", 20_000)
    scene = ran(Simulation(boxes(4), SOLUTIONS), 120)
    assert scene.bytes <= 20_000 and len(scene.past) < 25


def test_a_reset_is_the_start_and_forgets_the_past():
    scene = ran(Simulation(boxes(), SOLUTIONS), 40)
    scene.grab(1, (0.0, 0.0), (1.0, 1.0))
    ran(scene, 10).reset()
    assert scene.t == 0.0 and scene.grip is None and len(scene.past) == 1 and scene.apart() == 0.0
    assert scene.energy() == scene.expected() == pytest.approx(model_energy(boxes(), scene.now()))


def test_a_film_has_both_worlds():
    seconds, links, films = ran(Simulation(boxes(), SOLUTIONS), 60).pictures()
    assert seconds == pytest.approx(0.5, abs=0.04) and set(films) == {"mine", "pymunk"}
    assert all(points.shape == (2 + 4 + 4, 2) for frames in films.values() for points in frames) and len(links) == 9


# ---------------------------------------------------------------------------------------------- settings

def test_settings_change_the_motion_of_both_worlds_and_leave_the_bodies_where_they_are():
    scene = ran(Simulation(make_model([Body((0.0, 9.0), 1.0, Ball(0.1))], DOWN), SOLUTIONS), 60)
    before = scene.now()
    scene.set(g=0.0)
    assert all(np.array_equal(a, b) for a, b in zip(scene.now(), before, strict=True))
    lost = 0.5 * 9.81**2 * scene.tuning.dt * scene.t        # by symplectic Euler in free fall, as before the change
    assert scene.expected() - scene.energy() == pytest.approx(lost, rel=1e-9)
    ran(scene, 60)
    assert np.allclose(scene.now().v, before.v) and np.allclose(scene.engine_state.v, scene.now().v, atol=0.1)


def test_friction_of_the_slider_holds_a_block_that_slid():
    block = Body((0.0, 0.02), 1.0, Box((0.2, 0.02)), mu=0.0, v=(1.0, 0.0))
    scene = Simulation(make_model([FLOOR, block], DOWN), SOLUTIONS)
    ran(scene, 12)
    assert scene.now().v[1, 0] == pytest.approx(1.0)
    scene.set(mu=1.5)
    ran(scene, 24)
    assert abs(scene.now().v[1, 0]) < 1e-3 and abs(scene.engine_state.v[1, 0]) < 0.05


@pytest.mark.parametrize("change", [{"mu": -0.1}, {"e": 1.5}, {"dt": 0.0}, {"dt": np.inf}, {"sweeps": 0},
                                    {"g": np.nan}])
def test_a_setting_that_cannot_be_is_refused_and_nothing_changes(change):
    scene = Simulation(boxes(), SOLUTIONS)
    with pytest.raises(BadInput):
        scene.set(**change)
    assert scene.tuning == Tuning()


def test_pymunk_goes_on_from_its_own_state_after_a_setting():
    """Joints, too: their places are those of now and not those of the start."""
    bodies = [Body((0.0, 1.0), 1.0, Box((0.3, 0.05))), Body((0.6, 1.0), 1.0, Box((0.3, 0.05)))]
    model = make_model(bodies, DOWN, [Hinge(0, WORLD, (-0.3, 1.0)), Hinge(1, 0, (0.3, 1.0))])
    whole, changed = (ran(Simulation(model, SOLUTIONS), 40) for _ in range(2))
    changed.set(sweeps=21)
    ran(whole, 20), ran(changed, 20)
    assert np.allclose(whole.engine_state.x, changed.engine_state.x, atol=2e-3)
    assert np.ptp(whole.engine_state.x[:, 1]) > 0.05


@pytest.mark.parametrize("called", LOOPS)
def test_the_slider_of_dt_holds_for_every_lesson_from_end_to_end(called):
    """In the first prototype the pile of lesson 9 refused a step above 1/240 s.  A ball on the floor leaves nothing."""
    model = make_model([FLOOR, Body((0.0, 0.1), 1.0, Ball(0.1), mu=0.5)], DOWN)
    knob = next(one for one in drawn(Simulation(model, SOLUTIONS, lesson=called), "", 300, None)["knobs"]
                if one["key"] == "dt")
    for rate in (knob["low"], knob["high"]):
        scene = Simulation(model, SOLUTIONS, Tuning(), False, called)
        scene.set(dt=1.0 / rate)
        ran(scene, 20)
        assert scene.t == pytest.approx(20 / rate) and np.allclose(scene.now().x[1], (0.0, 0.1), atol=9.81 / rate**2)


def test_bodies_that_overlap_are_parted_and_their_overlap_is_shown():
    """A loop that only stops them leaves 40 mm for ever, which every viewer sees on a screen."""
    deep = [Body((0.0, 0.1), 1.0, Box((0.15, 0.1)), mu=0.5), Body((0.0, 0.26), 1.0, Box((0.15, 0.1)), mu=0.5)]
    scene = ran(Simulation(make_model([FLOOR, *deep], DOWN), SOLUTIONS, beside=False), 1)
    _, (_, low), (_, high) = scene.now().x
    assert scene.overlap() == pytest.approx(0.2 - (high - low), abs=1e-3) and scene.overlap() > 0.02
    ran(scene, 240)
    assert scene.overlap() < 2e-3 and scene.now().x[2, 1] == pytest.approx(0.3, abs=4e-3)


def test_a_model_in_space_is_refused():
    with pytest.raises(BadInput, match="a model for a live scene is one in space"):
        Simulation(make_model([Body((0.0, 0.0, 0.0), 1.0)], (0.0, 0.0, -9.81)), SOLUTIONS)


def test_a_rod_keeps_its_length_and_the_energy_of_its_balls():
    """A pendulum whose bob hangs on a rod from a fixed ball."""
    bodies = [Body((0.0, 0.0), np.inf, Ball(0.1)), Body((1.0, 0.0), 1.0, Ball(0.1))]
    scene = Simulation(make_model(bodies, DOWN, [Distance(0, 1, (0.0, 0.0), (0.0, 0.0))]), SOLUTIONS, beside=False)
    before = scene.energy()
    for _ in range(60):
        scene.step()
    x = scene.state.x
    assert np.linalg.norm(x[1] - x[0]) == pytest.approx(1.0, abs=1e-6) and abs(x[1, 1] - x[0, 1]) > 0.5
    assert scene.energy() == pytest.approx(before, abs=0.15)              # the first order of the loop, of 9.81 J


# ---------------------------------------------------------------------------------------------- the learner's file

FIRST_LINE = "    F, tau = load(t, x, q, v, omega, p)\n    return v + dt * p.inv_mass[:, None] * F,"


def with_line(line):
    return FIRST_LINE, f"    {line}\n{FIRST_LINE}"


HERE = r"\(simulator.py, line \d+, in new_velocities_2d\)\."
FAULTS = {                   # {line in new_velocities_2d: what the learner reads}
    'raise NotImplementedError("Exercise 10.1: new_velocities_2d")': "○ Not attempted yet: 10.1: new_velocities_2d.",
    "1 / 0": rf"✗ ZeroDivisionError: division by zero {HERE}",
    "no_such_name": rf"✗ NameError: name 'no_such_name' is not defined {HERE}",
    "v = v * np.nan": r"✗ the time \[s\] at which the motion is no longer finite = 0\.1\d+: take .+",
    "return v, omega, v": r"✗ ValueError: too many values to unpack .*\(parts.py, line \d+, in accelerated\)\.",
    "return v[:1], omega": r"✗ \w+Error: .+\.",
    "raise SystemExit": rf"✗ SystemExit: it gives no reason {HERE}",
}


@pytest.mark.parametrize("line", FAULTS)
def test_an_error_is_one_sentence_and_the_scene_goes_on_after_the_next_save(line, learner):
    scene = ran(Simulation(boxes(), learner.folder), 20)
    t, x = scene.t, scene.now().x.copy()
    learner("simulator", with_line(line))
    assert scene.follow()
    with pytest.raises((Exception, SystemExit)) as error:
        scene.step()
    said = sentence(error.value, learner.folder)
    assert "\n" not in said and re.match(FAULTS[line], said), said
    assert scene.t == t and np.array_equal(scene.now().x, x)
    learner("simulator")
    assert scene.follow()
    scene.step()
    assert scene.t > t


def test_a_file_that_cannot_be_loaded_is_told_and_tried_again_when_it_is_saved(learner):
    scene = ran(Simulation(boxes(), learner.folder), 5)
    learner("simulator", (FIRST_LINE, "    v = = 1\n"))
    assert scene.follow() and not scene.follow()
    for _ in range(2):
        with pytest.raises(BadInput, match=r"simulator.py cannot be loaded: SyntaxError: invalid syntax .*line \d+"):
            scene.step()
    learner("simulator")
    assert scene.follow()
    scene.step()


def test_a_lesson_that_is_called_is_followed_too(learner):
    """The sweeps are an exercise of contact.py."""
    scene = ran(Simulation(boxes(), learner.folder), 5)
    (learner.folder / "contact.py").write_text(stub((SOLUTIONS / "contact.py").read_text()))
    assert scene.follow()
    with pytest.raises(NotImplementedError, match="Exercise 9"):
        scene.step()


def test_a_save_changes_the_motion_and_not_the_state(learner):
    scene = ran(Simulation(make_model([Body((0.0, 9.0), 1.0, Ball(0.1))], DOWN), learner.folder, beside=False), 30)
    v = scene.now().v.copy()
    learner("simulator", (FIRST_LINE, FIRST_LINE.replace("v + dt", "v - dt")))
    scene.follow()
    scene.step()
    assert scene.now().v[0, 1] == pytest.approx(v[0, 1] + 9.81 / 120.0)


# ---------------------------------------------------------------------------------------------- earlier lessons

@pytest.fixture
def only(tmp_path):
    """only(lesson): a folder in which that lesson alone is solved."""
    def made(lesson):
        for file in SOLUTIONS.glob("*.py"):
            text = file.read_text()
            open_ = file.stem in lesson_names() and file.stem != lesson
            (tmp_path / file.name).write_text(stub(text) if open_ else text)
        return tmp_path
    return made


def test_a_ball_bounces_by_the_impulses_of_lesson_7_alone(only):
    """Each bounce reaches e² of the height, but for the step: it is found up to one step late."""
    ball = Body((0.0, 1.1), 1.0, Ball(0.1), e=0.8)
    scene = Simulation(make_model([FLOOR, ball], DOWN), only("impulses"), Tuning(dt=1 / 1000), False, "impulses")
    heights = [ran(scene, 1).now().x[1, 1] - 0.1 for _ in range(1000)]
    lands = int(np.argmax(np.array(heights) < 0.0))
    assert lands == pytest.approx(np.sqrt(2.0 / 9.81) * 1000, abs=3)
    assert max(heights[lands:]) == pytest.approx(0.64, abs=0.02)
    assert scene.energy() < scene.expected()


def test_a_box_that_lands_on_its_corner_turns_by_the_impulses_of_lesson_7(only):
    box = Body((0.0, 0.4), 1.0, Box((0.2, 0.1)), e=0.5, q=0.5)
    scene = Simulation(make_model([FLOOR, box], DOWN), only("impulses"), Tuning(), False, "impulses")
    ran(scene, 60)
    assert abs(scene.now().omega[1]) > 1.0 and scene.energy() < scene.expected()


def test_a_stack_stands_by_the_sweeps_of_lesson_9_alone(only):
    scene = Simulation(boxes(4), only("contact"), lesson="contact")
    ran(scene, 60)
    assert np.allclose(scene.now().x, [(0.0, 0.0), *((0.0, 0.1 + 0.2 * k) for k in range(4))], atol=2e-3)
    assert scene.apart() < 2e-3
