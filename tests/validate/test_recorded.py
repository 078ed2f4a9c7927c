"""The recorded runs of pybullet are those of today's scenes: a machine without pybullet shows nothing older."""

import json

import pytest

from validate.measure.selection import Plan, select
from validate.reference.stored import RECORDED
from validate.scene import PYBULLET
from validate.subject import modules

EVERYTHING = Plan(speeds=(), quick=False)


def recorded():
    """The names of all scenes that pybullet runs."""
    return [name for name in modules.scene_names()
            if any(r.who.product == PYBULLET for r in select(name, EVERYTHING).scene.engine_runners)]


@pytest.mark.parametrize("name", recorded())
def test_the_record_of_a_scene_has_its_settings_cases_steps_and_reasons(name):
    selection, kept = select(name, EVERYTHING), json.loads((RECORDED / f"{name}.json").read_text(encoding="utf-8"))
    scene = selection.scene
    witnesses = [r.who for r in scene.engine_runners if r.who.product == PYBULLET]
    assert kept["settings"] == {who.label: who.settings for who in witnesses}
    assert list(kept["runs"]) == list(scene.cases)
    for case, p in scene.cases.items():
        runners = {r.label: r for r in selection.engines_for(p) if r.who in witnesses and r.who.recorded_as is None}
        assert {label: [run["steps"] for run in runs] for label, runs in kept["runs"][case].items()} == {
            label: [n for n in selection.steps if n <= (r.who.most_steps or n)] for label, r in runners.items()}
        for label, runs in kept["runs"][case].items():
            reasons = {rule[1] for rule in getattr(runners[label].laws, "rules", ())}
            said = {law["reason"] for run in runs for law in run.get("laws", ())}
            assert said <= {"", *reasons}, label
