"""The report runs every exercise somewhere, and the table of coverage says where."""

import ast

import pytest

from solutions import integrators
from validate.run import coverage
from validate.subject import generate, modules

pytestmark = pytest.mark.xdist_group("coverage")


def test_every_exercise_is_run_by_a_scene_or_a_stability_case():
    assert coverage.missing() == []


def test_only_the_letter_of_a_choice_needs_no_place():
    """A worked answer that is no letter computes something, also without arguments: 8.21 and 11.19 return a thing."""
    table = coverage.table()
    for lesson in modules.lesson_names():
        functions = {node.name: node for node in coverage.trees()[lesson].body if isinstance(node, ast.FunctionDef)}
        for number, name in generate.exercises((modules.SOLUTIONS / f"{lesson}.py").read_text()).items():
            last = functions[name].body[-1]
            letter = isinstance(last, ast.Return) and ast.unparse(last.value) in [repr(one) for one in "ABCD"]
            assert (number in table) != letter, number
    assert "1.12" not in table and {"1.11", "8.21", "11.19"} <= table.keys()


def test_the_table_names_places_that_call_the_function():
    table = coverage.table()
    assert "oscillator" in table["1.3"]["places"]                                   # as a method
    assert "stability/springs/forces" in table["2.1"]["places"]                      # as an attribute of the lesson
    assert "spring_net" in table["2.7"]["places"]                                    # through mesh acceleration
    assert "stability/pbd/compliance" in table["8.12"]["places"]                     # through compliant_sweep
    assert "kepler" not in table["2.7"]["places"] and "oscillator" not in table["5.7"]["places"]


def test_every_given_function_that_moves_a_body_is_run_by_a_scene_or_a_stability_case():
    """Pictures and films call the others."""
    alone = {f"{module}.{name}" for module, functions in coverage.given().items()
             for name, places in functions.items() if not places}
    assert alone <= {"support.model.picture_of", "support.shapes.outline_of", "given.sensitivities.tangent_trajectory"}
    assert "stability/contact/contact-points" in coverage.given()["support.contact_points"]["edge_point"]
    assert "stability/simulator/loop-from-a-model" in coverage.given()["given.parts"]["accelerate_half"]


def test_an_exercise_that_nothing_runs_is_missing(monkeypatch):
    """What runs 2.4 is taken away: it is the only place."""
    left = {place: [name for name in names if name != "stability/springs/forces"]
            for place, names in coverage.places().items()}
    monkeypatch.setattr(coverage, "places", lambda: left)
    coverage.table.cache_clear()
    try:
        assert "2.4 soft_constraint_force" in coverage.missing()
    finally:
        coverage.table.cache_clear()


def test_functions_are_found_where_they_are_defined():
    assert coverage.defined(("pbd", "rope_step")) == ("given.ropes", "rope_step")
    assert coverage.defined(("simulator", "parting_aims")) == ("given.parts", "parting_aims")         # by a star
    begun = [("springs", "mass_spring_damper_step"), ("integrators", "euler_step")]
    assert ("integrators", "euler_step") in coverage.reached(begun)
    assert coverage.defined(("integrators", "no_such_thing")) is None and hasattr(integrators, "euler_step")
