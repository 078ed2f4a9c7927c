"""The engines' own switches: each acts on its part, changes what it must, and leaves nothing behind."""

import functools
import json

import pytest

from validate.engines.switches import worlds_made
from validate.measure import switches
from validate.measure.selection import Plan, select
from validate.report import audit, words
from validate.scene import MUJOCO, PYBULLET, PYMUNK

PLAN = Plan(quick=False, speeds=("plain",))


@functools.cache
def rolling():
    """What the scene of a rolling ball gives, measured once for all tests."""
    return parts("slide_then_roll")


def parts(name, **changes):
    """{(product, part): its row} of a scene."""
    selection = select(name, PLAN._replace(**changes))
    return {(row["product"], row["part"]): row for row in switches.engine_parts(selection, selection.first[1])}


def test_a_particle_has_no_part_to_leave_out():
    assert parts("throw") == {}


def test_without_collisions_or_friction_a_rolling_ball_moves_otherwise():
    found = rolling()
    product = next(iter(found))[0]
    assert found[product, "collision detection"]["change"] > 0.01
    assert found[product, "friction"]["change"] > 0.01
    assert words.change_without(found[product, "friction"]).startswith("changes by")
    assert [words.change_without({"change": size}) for size in (None, 7.0, 1e-12)] == ["lost", "another motion", "same"]


def test_joints_are_swept_even_where_nothing_collides():
    found = parts("rope", live=(PYMUNK,))
    assert ("pymunk", "all sweeps but one") in found and ("pymunk", "friction") not in found
    assert found["pymunk", "all sweeps but one"]["cost"] > 1.2


@pytest.mark.skipif(not MUJOCO.installed(), reason="MuJoCo is not installed here")
def test_mujocos_contacts_hold_a_block_and_its_memory_of_them_only_saves_time():
    found = parts("incline", live=(MUJOCO,))
    assert all(found["mujoco", part]["change"] > 0.01 for part in ("collision detection", "friction"))
    assert words.change_without(found["mujoco", "memory of contacts"]) == "same"
    assert 0.0 < found["mujoco", "all sweeps but one"]["change"] < 0.5
    assert parts("throw", live=(MUJOCO,)) == {}


@pytest.mark.skipif(not PYBULLET.installed(), reason="pybullet is not installed here")
def test_pybullet_forgets_a_switch_when_its_world_is_closed():
    selection = select("rolling_down", PLAN)
    engine = next(r.who for r in selection.engines_for(selection.first[1]) if r.who.product == PYBULLET)
    settings = []
    for _ in range(2):
        with worlds_made() as worlds:
            run = engine.make(selection.first[1], 0.01)
        bullet, = worlds
        known = bullet.pb.getPhysicsEngineParameters()
        settings.append({key: known[key] for key in ("numSolverIterations", "warmStartingFactor") if key in known})
        for switch in PYBULLET.adapter.SWITCHES:
            assert switch.off(bullet), switch.part
        run.close()
    assert settings[0] == settings[1] and settings[0]["numSolverIterations"] > 1


def test_the_audit_derives_the_cost_and_the_change_of_a_part_again():
    rows = json.loads(json.dumps(list(rolling().values())))
    times = {"rows": [], "time_to_error": [], "races": [], "calls": [], "ablations": [], "engine_parts": rows}
    result = {"cases": {"only": {"ours": [], "engines": []}}, "times": times}
    assert list(audit.of_times(result, {"times": 0})) == []
    rows[0]["cost"] *= 1.1
    rows[1]["change"] = 0.5
    assert len(list(audit.of_times(result, {"times": 0}))) == 2
