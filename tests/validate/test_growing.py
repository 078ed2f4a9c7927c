"""The scene that grows: without and with a part it differs by a number that theory gives."""

from itertools import pairwise

import numpy as np
import pytest

from solutions.checks import BadInput
from validate.notebook import growing
from validate.notebook.growing import actors, room, swaps
from validate.notebook.growing.parts import PARTS, borrowed, lesson_of
from validate.subject import needs
from validate.subject.modules import ROOT, SOLUTIONS

TIMES = room.FRAME * np.arange(room.PICTURES)


def films(number, thing):
    """(centres of the points of a thing without a part, the same with its worked answer), in every picture."""
    off, on = ({**borrowed(lesson_of(number)), number: part} for part in (PARTS[number].off, growing.worked()[number]))
    with np.errstate(all="ignore"):
        return [PARTS[number].actor(use)[thing].mean(axis=1) for use in (off, on)]


def speeds(height):
    """Velocities between pictures [m/s]."""
    return np.diff(height) / room.FRAME


def period(number):
    """(period without, with a part) of the swinging picture [s], from its ways through the vertical."""
    found = []
    for places in films(number, "picture"):
        x = places[:, 0] - room.NAIL[0]
        k = np.flatnonzero(x[:-1] * x[1:] < 0.0)
        zeros = TIMES[k] + room.FRAME * x[k] / (x[k] - x[k + 1])
        found.append(2.0 * np.mean(np.diff(zeros)))
    return found


def test_every_part_is_an_exercise_in_the_order_of_the_course_and_a_cell_of_its_notebook():
    order = list(needs.table())
    assert list(PARTS) == sorted(PARTS, key=order.index)
    texts = {lesson: next((ROOT / "notebooks").glob(f"{lesson:02}_*.ipynb")).read_text(encoding="utf-8")
             for lesson in range(1, 13)}
    assert [number for number in PARTS if f'grow(\\"{number}\\")' not in texts[lesson_of(number)]] == []


def test_the_film_of_a_lesson_has_two_exercises():
    whole = [lesson_of(number) for number, part in PARTS.items() if part.whole]
    assert sorted(whole) == sorted(2 * [*range(1, 12)])


REPEATED = {"9.2", "11.2", "11.10", "11.14"}      # within iterations, which get over an answer that is a little wrong


def scaled(found, factor):
    """What a function returned, each number times a factor, or without its last quarter of whole numbers."""
    if isinstance(found, tuple):
        parts = [scaled(part, factor) for part in found]
        return type(found)(*parts) if hasattr(found, "_fields") else tuple(parts)
    if isinstance(found, np.ndarray) and found.dtype.kind == "i":
        return found[:-len(found) // 4]
    return found if isinstance(found, int) else factor * found


NOT_WHOLE = [number for number, part in PARTS.items() if not part.whole]
FIRST = {lesson_of(number): number for number in reversed(NOT_WHOLE)}                   # of each lesson


@pytest.mark.parametrize("number", [
    pytest.param(number, marks=[] if number in FIRST.values() else pytest.mark.long) for number in NOT_WHOLE])
def test_a_film_shows_an_exercise_that_is_left_out_or_wrong(number):
    """Somewhere a point is 5 cm away, which is 17 pixels; a centimetre where each number is a fifth too small."""
    answer = growing.worked()[number]
    wrong = lambda *arguments: scaled(answer(*arguments), -1.0 if number in REPEATED else 0.8)
    off, on = (growing.moved([number], {number: function}) for function in (PARTS[number].off, answer))
    try:
        almost = growing.checked(growing.moved([number], {number: wrong}), on)
    except (ArithmeticError, BadInput):                 # grow says so in a sentence
        almost = off
    assert all(np.all(np.isfinite(places)) for places in on.values())
    for other, least in ((off, 0.05), (almost, 0.01)):
        assert max(np.max(np.abs(np.nan_to_num(other[thing], nan=9.0) - on[thing])) for thing in on) > least


@pytest.mark.parametrize(("number", "share"), [("4.6", 2.0 / 5.0), ("4.7", 1.0 / 2.0), ("4.8", 31.0 / 65.0)])
def test_what_rolls_down_the_lid_is_as_fast_as_its_moment_allows(number, share):
    R, x = 0.06, films(number, "roller")[1][:, 0]
    drop = room.LID[0, 1] - 0.35 * np.sin(room.SLOPE) + R * np.cos(room.SLOPE) - R
    assert speeds(x)[60] == pytest.approx(np.sqrt(2.0 * room.G * drop / (1.0 + share)), rel=0.01)


def test_a_disc_that_is_pushed_rolls_at_two_thirds_of_its_speed():
    off, on = (speeds(places[:, 0]) for places in films("10.11", "ball"))
    assert off == pytest.approx(1.6) and on[-1] == pytest.approx(2.0 / 3.0 * 1.6, rel=1e-6)


@pytest.mark.parametrize(("number", "miss"), [("12.1", 0.003), ("12.3", 0.003), ("12.4", 0.003), ("12.10", 1e-6)])
def test_the_aimed_throw_ends_at_its_target(number, miss):
    off, on = films(number, "ball")
    assert np.linalg.norm(off[-1] - swaps.TARGET) > 1.0 and np.linalg.norm(on[-1] - swaps.TARGET) < miss


def test_the_brick_keeps_its_spin_without_its_moments_and_turns_over_with_them():
    use = borrowed(5)
    turns = []
    for part in (PARTS["5.11"].off, growing.worked()["5.11"]):
        seen = PARTS["5.11"].actor({**use, "5.11": part})["die"]
        depth = seen[:, :4].mean(axis=1) - seen[:, 4:].mean(axis=1)      # along the axis of the spin, as drawn
        turns.append(np.ptp(depth, axis=0).max())
    assert turns[0] < 0.02 < 0.1 < turns[1]


def test_euler_throws_a_ball_half_v_dt_higher():
    off, on = (places[:, 1].max() for places in films("1.6", "ball"))
    v, y = room.ROOM.bodies[room.BALL].v[1], room.ROOM.bodies[room.BALL].x[1]
    assert on - y == pytest.approx(v * v / (2.0 * room.G), abs=room.G * actors.THROWN_DT**2 / 2.0)
    assert off - on == pytest.approx(0.5 * v * actors.THROWN_DT, abs=room.G * actors.THROWN_DT**2)


def test_euler_tears_the_curtain_apart_and_the_symplectic_step_does_not():
    off, on = films("1.5", "curtain")
    assert np.abs(off - off[0]).max() > 1.0 and np.abs(on - on[0]).max() < 0.15


def test_points_without_threads_fall_freely():
    off, on = films("2.7", "curtain")
    share, k = room.FREE.mean(), 9                       # the drag of the air on a point takes less than a tenth of g
    fall = 0.5 * room.G * TIMES[k] ** 2 * share
    assert 0.7 * fall < off[0, 1] - off[k, 1] < fall * 1.05 and np.ptp(on[:, 1]) < 0.09


def test_the_hem_hangs_2_to_8_cm_lower_in_the_end():
    use = {**borrowed(2), **{number: growing.worked()[number] for number in ("2.2", "2.7")}}
    hem = PARTS["2.7"].actor(use)["curtain"][:, -room.COLS:, 1]
    lower = hem[0] - hem[-1]
    assert 0.02 < lower.min() < 0.03 and 0.07 < lower.max() < 0.08


def test_wind_leans_the_curtain():
    off, on = films("2.2", "curtain")
    assert abs(off[60:, 0].mean() - off[0, 0]) < 0.01 and on[-1, 0] - on[0, 0] > 0.04
    assert np.ptp(on[60:], axis=0).max() < 0.2 * np.ptp(off[60:], axis=0).max()


def test_friction_stops_the_box_after_v_squared_over_two_mu_g():
    off, on = films("3.7", "box")
    assert on[-1, 0] - on[0, 0] == pytest.approx(4.0 / (2.0 * room.RUBS * room.G), rel=0.03)
    assert off[-1, 0] > room.SILL_END and off[-1, 1] == pytest.approx(0.07)


def test_the_book_stays_with_friction_and_slides_without():
    off, on = films("3.16", "book")
    k = 15
    assert np.linalg.norm(on[-1] - on[0]) < 1e-12
    assert np.linalg.norm(off[k] - off[0]) == pytest.approx(0.5 * room.G * np.sin(room.SLOPE) * TIMES[k] ** 2, rel=0.03)


@pytest.mark.parametrize(("number", "I"), [("4.5", 0.18**2), ("4.11", (0.25 + 0.1296) / 12.0)])
def test_the_picture_swings_with_the_period_of_its_moment(number, I):
    full = (0.25 + 0.1296) / 12.0 + 0.18**2
    longer = 1.0 + room.TILT**2 / 16.0                   # of a swing that is not small
    for found, moment in zip(period(number), (I, full), strict=True):
        assert found == pytest.approx(2.0 * np.pi * np.sqrt(moment / (room.G * room.HANGS)) * longer, rel=0.01)


def test_the_die_turns_three_times_and_the_top_goes_round():
    use = borrowed(5)
    off, on = (actors.die({**use, "5.10": part})["die"] for part in (PARTS["5.10"].off, growing.worked()["5.10"]))
    own = lambda die: die - die.mean(axis=1, keepdims=True)
    assert np.abs(own(off) - own(off)[0]).max() < 1e-12
    turn = round(2.0 * np.pi / np.linalg.norm(actors.TURNS) / room.FRAME)
    assert np.abs(own(on)[turn] - own(on)[0]).max() < 0.02 < np.abs(own(on)[turn // 2] - own(on)[0]).max()
    still, round_it = (PARTS["5.15"].actor({**use, "5.15": part})["top"][:, 1] - room.FOOT
                       for part in (PARTS["5.15"].off, growing.worked()["5.15"]))
    assert np.abs(still - still[0]).max() < 1e-9
    away = np.linalg.norm(round_it - round_it[0], axis=1)
    assert away[51] > 0.2 and away[86:].min() < away[51]          # half a turn after 1.7 s, at mgl/(I₃ ω₃)


def test_the_ball_finds_rail_and_floor():
    ball, rail = room.ROOM.bodies[room.BALL], room.ROOM.bodies[room.RAIL]
    off, on = films("6.4", "ball")
    reach = ball.shape.radius + rail.shape.radius
    assert off[:, 1].max() > 2.0 and np.linalg.norm(off - rail.x, axis=1).min() > reach        # each step ends outside
    assert on[:, 1].max() < rail.x[1] and np.linalg.norm(on - rail.x, axis=1).min() > reach - 1e-9
    off, on = films("6.2", "ball")
    assert off[-1, 1] < -1.0 and on[:, 1].min() >= ball.shape.radius - 1e-9


def test_each_bounce_has_e_squared_of_the_height_of_the_last():
    off, on = (places[:, 1] - room.ROOM.bodies[room.BALL].shape.radius for places in films("7.4", "ball"))
    peaks = [on[k] for k in range(12, len(on) - 1) if on[k - 1] < on[k] >= on[k + 1]]
    for before, after in pairwise(peaks):
        assert after / before == pytest.approx(room.BOUNCES**2, abs=0.03)
    assert [round(100.0 * peak) for peak in peaks[:4]] == [114, 73, 47, 30]          # as the notebook says [cm]
    assert off[30:].max() < 1e-9


def test_friction_turns_the_ball_and_takes_a_third_of_its_slip():
    spokes = []
    for part in (PARTS["7.10"].off, growing.worked()["7.10"]):
        seen = actors.ball({**borrowed(7), "7.10": part})["ball"]
        spokes.append(seen[:, 0] - seen.mean(axis=1))
    off, on = spokes
    assert np.abs(off - off[0]).max() < 1e-12 and np.abs(on - on[0]).max() > 0.05
    x = films("7.10", "ball")[1][:, 0]
    r = room.ROOM.bodies[room.BALL].shape.radius
    turn = np.unwrap(np.arctan2(on[:, 1], on[:, 0]))
    assert speeds(turn)[70] * -r == pytest.approx(speeds(x)[70], rel=0.02)          # it rolls off: no slip is left
    before, spin = speeds(x)[8], -r * speeds(turn)[8]    # between rail and floor: it spins backwards
    assert speeds(x)[13] == pytest.approx(before - (before - spin) / 3.0, rel=0.01)


def test_threads_do_not_stretch_and_no_point_is_inside_the_ball(monkeypatch):
    found, whole = [], actors.hanging
    monkeypatch.setattr(actors, "hanging", lambda step, **steps: found.append(whole(step, **steps)) or found[-1])
    for functions in ({number: PARTS[number].off for number in ("8.6", "8.11")}, growing.worked()):
        actors.cloth({**borrowed(8), **functions})
    i, j = room.THREADS.T
    off, on = (np.max(np.linalg.norm(x[:, i] - x[:, j], axis=2) / room.LONG) - 1.0 for x in found)
    assert off > 0.25 and on < 0.06
    centres = np.array([room.cushion(t) for t in TIMES])[:, None]
    off, on = (room.CUSHION - np.min(np.linalg.norm(x - centres, axis=2)) for x in found)
    assert off > 0.1 and on < 1e-12


def test_the_stack_stands_by_sweeps_and_by_memory():
    for number, sinks in (("9.4", 40.0), ("9.14", 0.3)):
        off, on = films(number, "stack")
        assert off[0, 1] - off[-1, 1] > sinks and abs(on[0, 1] - on[-1, 1]) < 0.002


def test_weight_bends_the_flight_of_the_parcel():
    off, on = films("10.1", "parcel")
    k = 15
    assert off[k, 1] - on[k, 1] == pytest.approx(0.5 * room.G * TIMES[k] ** 2, rel=0.03)


def test_the_loop_lets_nothing_fall_out_of_the_room():
    use = growing.worked()
    off, on = (actors.pile({**use, "10.6": part}) for part in (PARTS["10.6"].off, use["10.6"]))
    assert all(places[-1, :, 1].max() < -30.0 for places in off.values())
    assert all(places[..., 1].min() > -0.02 for places in on.values())
    box = on["box"].mean(axis=1)
    assert box[-1, 0] - box[0, 0] == pytest.approx(4.0 / (2.0 * room.RUBS * room.G), rel=0.05)


def test_the_hand_takes_the_curtain_along_and_keeps_its_limit():
    use = borrowed(11)
    wishes = np.array([room.wish(t) for t in TIMES])
    for number, miss in (("11.11", 2e-4), ("11.15", 4e-4)):
        angles = actors.arm_angles({**use, number: growing.worked()[number]})
        assert np.linalg.norm([room.joints(theta)[-1] for theta in angles] - wishes, axis=1).max() < miss
        assert (angles[:, 2].min() >= room.WRIST) == (number == "11.15")
        widest = room.WRIST if number == "11.15" else np.radians(53.0)
        assert angles[:, 2].min() == pytest.approx(widest, abs=0.01)
    off, on = films("11.11", "curtain")
    assert np.ptp(off[-30:, 0]) < 0.02 and on[-1, 0] < off[-1, 0] - 0.15


def test_a_function_that_returns_nonsense_ends_in_one_sentence(monkeypatch):
    said = []
    monkeypatch.setattr(growing, "display", lambda shown: said.append(shown.data))
    monkeypatch.setattr("validate.notebook.display", lambda shown: said.append(shown.data))

    class Mine:
        impulse_size = staticmethod(lambda *_: float("nan"))
    monkeypatch.setattr(growing, "mine", lambda lesson: Mine)
    growing.grow("7.4")
    assert "the ball is nowhere" in said[0] and said[-1].count('"label":"with') == 1
    said.clear()
    growing.grow("7.99")
    assert len(said) == 1 and "7.99" in said[0] and "choose from" in said[0]


def test_the_pair_of_a_lesson_is_small_and_shows_both(monkeypatch):
    said = []
    monkeypatch.setattr(growing, "display", lambda shown: said.append(shown.data))
    monkeypatch.setenv("WORKBOOK_LESSONS", str(SOLUTIONS))
    growing.grow("2")
    assert said[0].count('"label":"with') == 2 and len(said[0]) < 130_000
