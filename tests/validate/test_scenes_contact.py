"""Scenes of lesson 9: a wrong answer departs from the truth in the case that should notice it."""

import numpy as np
import pytest

from validate import measure
from validate.check import is_right
from validate.engines.products import PYMUNK
from validate.measure import film, record
from validate.measure.selection import can_do
from validate.reference.contact import Towers, sway_of_tower, unrest_in_pymunk
from validate.reference.stored import numbers
from validate.scenes.contact import mass_ratio, piles, stack
from validate.scenes.contact._common import DT, OVERLAP, frictions, in_tower
from validate.subject import modules

TEXT, SIMULATOR = ((modules.SOLUTIONS / f"{name}.py").read_text(encoding="utf-8") for name in ("contact", "simulator"))
WRONG = [                    # scene, case, method, a right line, a wrong one
    ("mass_ratio", "relaxed sweeps, 10 : 1", "sweeps, counted", "omega = 2.0 / (1.0 + np.sqrt(1.0 - rho))",
     "omega = 1.7"),
    ("mass_ratio", "sweeps, 10 : 1", "sweeps, counted", "(A[k] @ lam + b[k]) / A[k, k])", "(A[k] @ lam + b[k]))"),
    ("mass_ratio", "overlap, 10 : 1", "pile", "s = 2.0 * np.pi * hertz * dt", "s = 1.9 * np.pi * hertz * dt"),
    ("mass_ratio", "a million on 1, refused", "sweeps", 'raise Diverged("residual of the', 'return J\n    print("'),
    ("mass_ratio", "forces, a million : 1", "Murty", "A[k], 0.0), -b[k]", "A[k], 0.0), -1.00001 * b[k]"),
    ("critical_friction", "ladder at 60°", "sweeps", "(A[t] @ J + b[t]) / A[t, t], -limit), limit)",
     "(A[t] @ J + b[t]) / A[t, t], -1.001 * limit), 1.001 * limit)"),
    ("arch", "least thickness, 4 stones", "sweeps", "sign * (r_x * d_y - r_y * d_x)", "sign * 1.1 * r_x * d_y"),
    ("dominoes", "six", "pile", "pile.mu * J_n if", "0.5 * pile.mu * J_n if"),
    ("piles", "12 spheres", "pile in space", "return scaled(1.0, J) if size <= limit else scaled(limit / size, J)",
     "return scaled(1.0, J)"),
]


@pytest.mark.long
@pytest.mark.parametrize(("scene", "case", "method", "right", "wrong"), WRONG,
                         ids=[f"{scene}-{k}" for k, (scene, *_) in enumerate(WRONG)])
def test_a_wrong_answer_departs(tmp_path, scene, case, method, right, wrong):
    assert TEXT.count(right) == 1, "the wrong line may stand in another exercise"
    for lesson, text in (("contact", TEXT.replace(right, wrong)), ("simulator", SIMULATOR)):
        (tmp_path / f"{lesson}.py").write_text(text.replace("from .", "from solutions."))
    result = measure.errors(scene, measure.Plan(of=str(tmp_path), speeds=("plain",), live=()))
    verdicts = {c["label"]: is_right(c) for c in result["cases"][case]["ours"]}
    assert verdicts[method] is False, verdicts


TOWERS = pytest.mark.parametrize("scene", [stack, mass_ratio], ids=["stack", "mass_ratio"])


@pytest.mark.long
@TOWERS
def test_the_stored_numbers_of_towers_are_those_of_the_reference(scene):
    """To half of them, since rounding in another order changes what is left of the rocking."""
    found, known = record.numbers_of(scene.SCENE), numbers(scene.__name__.rpartition(".")[2])
    assert found.keys() == known.keys()
    assert [found[key] for key in known] == pytest.approx(list(known.values()), rel=0.5, abs=1e-12)


@TOWERS
def test_the_limits_of_towers_compute_no_number_that_is_stored(scene, monkeypatch):
    def refuse(function):
        def refused(*arguments):
            raise AssertionError(f"{function.__name__}{arguments}")
        refused.__name__ = function.__name__
        return refused
    for function in (sway_of_tower, unrest_in_pymunk):
        monkeypatch.setattr(scene, function.__name__, refuse(function))
    for runner in scene.SCENE.runners:
        assert all(runner.largest_error(p, 1.0) > 0.0 for p in scene.CASES.values() if can_do(runner, p))
    with pytest.raises(AssertionError, match="sway_of_tower"):
        scene.sway(scene.Params(size=2.0))


@pytest.mark.parametrize("case", ["12 spheres", "30 discs"])
def test_a_pile_is_filmed_inside_the_edges_of_its_container(case):
    """The edges touch the planes of the container and surround the first places of all bodies, with their radii."""
    p = piles.CASES[case]
    _, (first, *_) = piles.our_film(p)
    edges = np.reshape(film.packed(piles.bodies(p), {}, 1.0, walls=piles.walls(p))["walls"], (-1, 3))
    planes = piles.start(p)[1].planes
    gaps = edges[:, 3 - len(planes[0]) + 1:] @ planes[:, :-1].T + planes[:, -1]     # discs stand in the plane x = 0
    assert np.min(gaps, axis=0) == pytest.approx(0.0, abs=1e-12)
    radii = [body["r"] for body in piles.bodies(p)]
    assert np.max(edges[:, 2]) == pytest.approx(np.max(first[:, 2] + radii), abs=1e-12)


@pytest.mark.parametrize("steps", [1, 4, 24])
def test_the_reference_of_pymunks_towers_errs_as_the_engine_does(steps):
    """While the tower falls into its joints, when errors are largest: to a hundredth of them."""
    p = stack.Params(n=5, m=2.0)
    wait = in_tower(PYMUNK, stack.model, stack.answer, steps * DT, iterations=10, slop=0.1, overlap=OVERLAP)
    forces, truth = wait(p, 1.0).read(), stack.truth(p, 1.0)
    how = Towers(DT, 10, 0.1, OVERLAP, frictions(stack.model(p)), steps * DT)
    found = np.linalg.norm(forces - truth) / np.linalg.norm(truth)
    assert unrest_in_pymunk((p.m,) * p.n, p.size, p.g, how) == pytest.approx(found, rel=0.01)
