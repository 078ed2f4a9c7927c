"""Laws that judge engines where no theory gives their error: joints stay closed, the energy stays, and contacts too."""

import numpy as np
import pytest

from solutions.support.model import WORLD, Body, Hinge, State, make_model
from validate.check import BY_LAWS, JointsAllowed, Verdict
from validate.engines import watched
from validate.engines.products import PRODUCTS
from validate.measure.accuracy import laws_for
from validate.reference import joint_laws
from validate.reference.joint_laws import Reading, judged, verdict_on
from validate.report import audit
from validate.scenes._common import built
from validate.scenes.simulator import bricard, four_bars, rolling_box, squeezer
from validate.subject import modules

TURN = 0.01                  # of the invented steps [rad]
EVERY = [(home, case, runner) for home, case in ((bricard, "from the cube"), (four_bars, "one"), (four_bars, "40"),
                                                 (squeezer, "as published"), (rolling_box, "published"))
         for runner in home.SCENE.engine_runners]
STEPS = {bricard: 200, four_bars: 400, squeezer: 1000, rolling_box: 400}
NOTICED = 80                 # steps of the box that show a fault of 10 %


def name_of(one):
    return one if isinstance(one, str) else getattr(one, "label", getattr(one, "__name__", "").split(".")[-1])


def verdict_of(home, case, runner, change=lambda model: model, steps=None):
    """Return the Verdict by laws on an engine that runs a changed Model and is judged by the unchanged one."""
    if not runner.who.product.installed():
        pytest.skip(f"no {runner.who.product}")
    p, steps = home.CASES[case], steps or STEPS[home]
    run = changed(home, runner, change)(p, home.T / STEPS[home])
    kept = [run.watched_step() for _ in range(steps)]
    run.close()
    laws = laws_for(runner.laws)
    return laws.verdict_on(laws.judged(kept, runner.laws))[0]


def changed(home, runner, change):
    """Return make(p, dt) of the runner's world, with another Model in it."""
    make = runner.who.make
    about = dict(zip(make.__code__.co_freevars, (cell.cell_contents for cell in make.__closure__), strict=True))
    return built(about["product"], lambda p: change(home.model(p)), home.read, about["watch"], **about["settings"])


# ---------------------------------------------------------------------------------------------- what is measured

def test_the_gap_and_the_energy_of_a_rod_that_steps_along_its_tangent():
    """The hinge is at the lever r from the centre: x = r (1, ω t) instead of r (cos ω t, sin ω t)."""
    r, omega, dt, m, g = 0.5, 2.0, 0.01, 3.0, 9.81
    rod = Body((r, 0.0), m, inertia=0.2, v=(0.0, r * omega), omega=omega)
    watching = watched.Joined(make_model([rod], (0.0, -g), [Hinge(0, WORLD, (0.0, 0.0))]), dt, omega,
                              lambda before, after: 0.125)
    x, q = np.array([[r, r * omega * dt]]), np.array([omega * dt])
    watching.step, watching.state = lambda: None, lambda: State(x, q, np.array([[0.0, r * omega]]), np.array([omega]))
    reading = watching.watched()
    gap = np.hypot(r - r * np.cos(omega * dt), r * omega * dt - r * np.sin(omega * dt)) / r
    assert reading.gap == pytest.approx(gap, rel=1e-12)
    assert gap == pytest.approx(0.5 * (omega * dt) ** 2, rel=1e-3)
    assert reading.energy == pytest.approx(m * g * r * omega * dt - 0.125)
    assert reading.kinetic == pytest.approx(0.5 * m * (r * omega) ** 2 + 0.5 * 0.2 * omega**2)
    assert reading.turn == omega * dt


# ---------------------------------------------------------------------------------------------- verdicts

def readings(gap=0.5, energy=0.5, order=1):
    """Return the Readings of a run with these shares of what the laws allow."""
    found = Reading(gap * TURN**2, energy * (0.5 * TURN if order == 1 else TURN**2) * 7.0, 7.0, TURN)
    return [found._replace(gap=0.0, energy=0.0), found, found._replace(gap=0.0, energy=-0.5 * found.energy)]


@pytest.mark.parametrize("order", [1, 2])
def test_each_law_holds_up_to_its_limit(order):
    allowed = JointsAllowed(order)
    for shares, verdict in (((0.9, 0.9), Verdict.KEEPS_LAWS), ((1.1, 0.9), Verdict.DEPARTS),
                            ((0.9, 1.1), Verdict.DEPARTS), ((0.9, -1.1), Verdict.DEPARTS),
                            ((np.nan, 0.9), Verdict.DEPARTS), ((0.9, np.nan), Verdict.DEPARTS)):
        laws = judged(readings(*shares, order), allowed)
        assert verdict_on(laws)[0] is verdict, shares
        stored = [{**law._asdict(), "found": None if np.isnan(law.found) else law.found} for law in laws]
        assert audit.verdict_by_laws(stored) is verdict


def test_a_law_that_an_engine_is_known_to_break_has_its_reason_and_its_bound():
    soft = JointsAllowed(2, (("energy", "it is soft", 2.0),))
    assert verdict_on(judged(readings(0.5, 1.9, 2), soft)) == (
        Verdict.BREAKS_AS_KNOWN, f"{joint_laws.QUANTITIES['energy'].removesuffix(' [-]')}: 0.00019, because it is soft")
    assert verdict_on(judged(readings(0.5, 2.1, 2), soft))[0] is Verdict.DEPARTS
    assert verdict_on(judged(readings(1.1, 0.5, 2), soft))[0] is Verdict.DEPARTS
    open_ = watched.sweeps_over_joints("its sweeps end")
    assert verdict_on(judged(readings(100.0, 100.0), open_))[0] is Verdict.BREAKS_AS_KNOWN
    assert verdict_on(judged(readings(np.nan, 0.5), watched.sweeps_over_joints()))[0] is Verdict.DEPARTS


# ---------------------------------------------------------------------------------------------- engines

@pytest.mark.long
@pytest.mark.parametrize(("home", "case", "runner"), EVERY, ids=name_of)
def test_no_engine_breaks_a_law_but_by_its_own_rule(home, case, runner):
    assert verdict_of(home, case, runner) in BY_LAWS


def faster(model):
    return model._replace(gravity=tuple(1.1 * np.array(model.gravity)))


def heavier(model):
    first, *others = model.bodies if np.isfinite(model.bodies[0].m) else model.bodies[::-1]
    bodies = (first._replace(m=1.1 * first.m, inertia=1.1 * np.array(first.inertia)), *others)
    return model._replace(bodies=bodies if np.isfinite(model.bodies[0].m) else bodies[::-1])


def unhinged(model):
    return model._replace(joints=model.joints[:-1])


def stronger(model):
    """Return the squeezer with 10 % more torque on its crank."""
    def load(t, x, q, v, omega):
        F, tau = model.loads[0](t, x, q, v, omega)
        return F, 1.1 * tau
    return model._replace(loads=(load,))


def rougher(factor):
    return lambda model: model._replace(bodies=tuple(body._replace(mu=factor * body.mu) for body in model.bodies))


# what has a rule without a bound is not judged so sharply
ONE = [each for each in EVERY if each[1] in ("one", "as published", "published")
       and not (each[0] is four_bars and each[2].laws.order == 1 and each[2].laws.rules)]
FAULTS = {"gravity 10 % too large": (faster, (four_bars, rolling_box)),
          "a body 10 % too heavy": (heavier, (rolling_box,)),
          "a hinge left out": (unhinged, (squeezer,)),
          "a torque 10 % too large": (stronger, (squeezer,)),
          "friction 21 % too large": (rougher(1.1), (rolling_box,)),
          "friction 19 % too small": (rougher(0.9), (rolling_box,))}


@pytest.mark.parametrize(("fault", "home", "case", "runner"), [
    pytest.param(fault, *each, marks=[] if each[2].who.product is PRODUCTS[0] else pytest.mark.long)
    for fault, (_, homes) in FAULTS.items() for each in ONE if each[0] in homes], ids=name_of)
def test_an_engine_whose_physics_is_wrong_departs(fault, home, case, runner):
    steps = NOTICED if home is rolling_box else None
    assert verdict_of(home, case, runner, FAULTS[fault][0], steps) is Verdict.DEPARTS


@pytest.mark.long
def test_no_curve_of_an_engine_is_left_undecided():
    """The rule for every scene: where theory gives no limit, laws judge the engine, or its run is the truth."""
    for name in modules.scene_names():
        scene = modules.bind_scene(name)
        for runner in scene.engine_runners:
            for p in scene.cases.values():
                if runner.supports is None or runner.supports(p):
                    finite = np.isfinite(runner.largest_error(p, scene.duration / scene.steps[-1]))
                    assert finite or runner.laws or runner.is_reference(p), (name, runner.label)
