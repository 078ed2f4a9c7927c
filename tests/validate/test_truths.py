"""Truths of scenes, compared with what the worked answers find on another way."""

import functools
import types

import numpy as np
import pytest

from validate.engines.products import Product
from validate.reference.springs import modes
from validate.scenes.friction import stick_slip
from validate.scenes.inertia_tensors import tensors
from validate.scenes.springs import samples_per_frame, spring_net
from validate.scenes.springs._common import net_points
from validate.subject import modules

LESSONS = modules.PLAIN.lessons


def test_event_steps_find_the_times_of_the_slips():
    """v(t) at the end of a slip is wrong by dt² Aω² s/24, and falls there at more than μg − A |cos ωt| > 0.3 m/s²."""
    p, dt = stick_slip.CASES["F = 8 cos t"], 0.001
    late = dt**2 * p.force * p.omega**2 * 0.6 / 24.0 / 0.3
    law, (x, v, block) = LESSONS.friction.driven_acceleration, stick_slip.start(p)
    found = LESSONS.friction.slip_times(law, 0.0, x, v, dt, round(stick_slip.T / dt), block)
    expected = np.array([[begin, end] for begin, end, _, _ in stick_slip.slips(p)])
    assert np.max(np.abs(found - expected)) < late + 1e-12


def test_the_parts_of_an_uneven_dumbbell_have_its_centre():
    p = tensors.CASES["uneven dumbbell"]
    centre = LESSONS.inertia_tensors.combine(*tensors.parts(LESSONS, p)).x
    assert centre == pytest.approx(tensors.centre(p), abs=1e-15)


@pytest.mark.parametrize("samples", samples_per_frame.SAMPLES[:3])
def test_the_fastest_mode_of_a_net_grows_as_its_determinant_says(samples):
    """|λ₁ λ₂| = det A = (1 − ½ω²dt²)(1 − c dt) + ω² dt (dt − ½c dt²) = 1 − c dt + ½ω² dt²;  |λ|² of a complex pair."""
    scene, integrators = samples_per_frame, LESSONS.integrators
    omega, c = (values[-1] for values in modes(scene.square_net(scene.CASES["net"]))[:2])
    dt = 1.0 / (scene.FRAMES_PER_SECOND * samples)
    A = integrators.amplification_matrix(integrators.average_velocity_step, omega, 0.5 * c / omega, dt)
    assert np.linalg.det(A) == pytest.approx(1.0 - c * dt + 0.5 * (omega * dt) ** 2, abs=1e-12)


@pytest.mark.parametrize(("samples", "said", "digit"), [(4, 0.03, 0.005), (16, 0.008, 0.0005)])
def test_the_lectures_steps_err_as_the_scene_says(samples, said, digit):
    """Its docstring rounds the error of the worst node to one digit."""
    scene = modules.bind_scene("samples_per_frame")
    p, steps = scene.parameters, round(samples_per_frame.FRAMES_PER_SECOND * samples * scene.duration)
    step, dt = LESSONS.integrators.average_velocity_step, scene.duration / steps
    end = scene.observe(scene.run(scene.lessons, step, scene.law, scene.start(p), p, dt, steps), p)
    off = net_points(end - scene.truth(p, scene.duration), p)
    assert np.linalg.norm(off, axis=1).max() == pytest.approx(said, abs=digit)


@pytest.mark.parametrize("p", spring_net.CASES.values(), ids=list(spring_net.CASES))
def test_a_net_of_the_lesson_has_the_springs_and_the_rest_state_of_the_reference(p):
    springs, net = LESSONS.springs, spring_net.square_net(p)
    offsets = springs.STRUCTURAL + springs.SHEAR * p.shear + springs.BEND * p.bend
    ours = {tuple(sorted(pair)) for pair in springs.grid_pairs(p.n, p.n, offsets).tolist()}
    assert ours == set(map(tuple, net.pairs.tolist()))
    _, v, network = spring_net.SCENE.start(p)
    assert np.abs(springs.spring_network_acceleration(0.0, spring_net.rest_positions(net), v, network)).max() < 1e-10


# ---------------------------------------------------------------------------------------------- who made them

def called(function, found=None):
    """All functions and classes of `validate` that a function names, and that these name."""
    found = set() if found is None else found
    function = getattr(function, "__wrapped__", function)
    function = function.func if isinstance(function, functools.partial) else function
    if isinstance(function, Product):
        found.add(function)
    if not isinstance(function, types.FunctionType | type) or not function.__module__.startswith("validate."):
        return found
    if function not in found:
        found.add(function)
        for value in named_by(function) if isinstance(function, types.FunctionType) else ():
            called(value, found)
    return found


def named_by(function):
    """What the names in a function's code mean, those of functions inside it included, and what it closes over."""
    codes, names = [function.__code__], set()
    while codes:
        code = codes.pop()
        names |= {*code.co_names}
        codes += [one for one in code.co_consts if isinstance(one, types.CodeType)]
    cells = [cell.cell_contents for cell in function.__closure__ or ()]
    return [function.__globals__[name] for name in names if name in function.__globals__] + cells


def test_a_truth_that_can_run_an_engine_says_in_which_cases_it_does_and_no_other_has_such_a_rule():
    """The engine is then a reference in the report: it must not judge itself."""
    for name in modules.scene_names():
        scene = modules.bind_scene(name)
        runs_an_engine = any(isinstance(one, Product) or one.__module__.startswith("validate.engines")
                             for one in called(scene.truth))
        says_so = any(r.is_truth is not None for r in scene.engine_runners)
        assert runs_an_engine == says_so, name
