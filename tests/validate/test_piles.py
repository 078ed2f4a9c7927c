"""Piles against engines: settings, and what is printed and drawn of measured times."""

from concurrent.futures.process import BrokenProcessPool

import numpy as np
import pytest

from solutions.checks import BadInput
from solutions.support.scenes import HIGHEST
from validate.engines.contact import DT, KINDS, fallen
from validate.speed import opponents, piles
from validate.subject import modules


def test_our_settings_against_an_engine_are_fewer_substeps_that_can_carry_their_hertz():
    for rival in piles.PLANE + piles.SPACE:
        for name, (substeps, hertz) in rival.ours.items():
            assert substeps < KINDS[name].substeps
            assert hertz * DT / substeps <= HIGHEST + 1e-12


@pytest.mark.parametrize(("substeps", "hertz"), [
    KINDS["boxes"][-2:], *{r.ours["boxes"] for r in piles.PLANE if "boxes" in r.ours and r.ours["boxes"][0] > 1}])
def test_a_free_tower_of_boxes_comes_to_rest_with_our_settings(substeps, hertz):
    fastest = sway_of_a_tower(substeps, hertz)
    assert fastest[-1] < 0.2 * fastest[1]


def sway_of_a_tower(substeps, hertz):
    """The largest speed [m/s] in each of five seconds after the top of six boxes was pushed."""
    lesson = piles.compiled_lesson() if modules.can_compile() else modules.bind("contact")
    half = np.random.default_rng(0).uniform(0.08, 0.12, (6, 2))
    x = np.stack((np.zeros(6), 2.0 * np.cumsum(half[:, 1]) - half[:, 1]), axis=1)
    m = 4000.0 * np.prod(half, axis=1)
    state, pile = lesson.make_pile_2d(x, np.zeros(6), m, m * np.sum(half**2, axis=1) / 3.0, half, [(0.0, 1.0, 0.0)],
                                      (0.0, -9.81), 0.5, substeps, hertz, 10.0, 0.008)
    v = state.v.copy()
    v[5, 0] = 0.02
    state, fastest = state._replace(v=v), []
    for _ in range(5):
        speeds = []
        for _ in range(24):
            state = lesson.advance_pile_2d(lesson.box_bounds_2d, lesson.box_contacts_2d, state, DT, 10, pile)
            speeds.append(np.max(np.abs(state.v)))
        fastest.append(max(speeds))
    return fastest


def test_settings_change_nothing_else_of_a_pile():
    kind = KINDS["bricks"]._replace(across=2)
    pile, tuned = fallen(kind, 4)[1], next(r for r in piles.SPACE if r.goal and "bricks" in r.ours)
    ours = piles.with_settings(pile, tuned, "bricks")
    assert (ours.substeps, ours.hertz) == tuned.ours["bricks"]
    assert all(a is b for a, b in zip(ours[:6], pile[:6], strict=True)) and ours.margin == pile.margin
    assert piles.with_settings(pile, piles.SPACE[0], "bricks") == pile


def test_a_cost_that_grows_as_n_has_the_power_of_one():
    n = np.array(piles.SIZES)
    assert piles.power(n, 3e-4 * n) == pytest.approx(1.0)
    assert piles.power(n, 3e-4 * n * n) == pytest.approx(2.0)


def test_an_engine_that_is_not_installed_has_a_dash():
    assert piles.known(piles.power([100, 1000], [np.nan, np.nan]), ".2f") == "–" and piles.known(1.054, ".2f") == "1.05"


@pytest.mark.parametrize("d", [2, 3])
def test_the_floor_reaches_under_the_walls_however_far_apart_they_stand(d):
    for wall in (5.0, 60.0, 600.0):
        (floor, half), *sides = opponents.slabs(wall, d)
        assert floor[-1] == -half[-1] and min(half[:-1]) >= wall + opponents.THICK and len(sides) == 2 * (d - 1)
        faces = [np.array(centre) - np.sign(centre) * half * (np.array(centre) != 0.0) for centre, half in sides]
        assert np.allclose(sorted(np.abs(faces).max(axis=1)), wall)


def test_memory_that_an_engine_holds_is_what_it_takes():
    before = piles.held_memory()
    taken = np.ones(2**25)                                               # 0.25 GiB
    assert taken.any() and (np.isnan(before) or piles.held_memory() - before == pytest.approx(0.25, abs=0.02))


def test_growth_and_races_are_printed_and_drawn(monkeypatch, tmp_path, capsys):
    sizes = []

    def grown(function, name, asked, rounds):
        sizes.append(asked)
        return [piles.Size(n, 2 * n, 3e-4 * n, 6e-4 * n, 0.1, 0.2) for n in asked]
    monkeypatch.setattr(piles, "alone", grown)
    piles.measure(["discs", "bricks"], 0, 9, True, False, tmp_path / "growth.png", 3162)
    said = capsys.readouterr().out
    assert sizes == [[100, 316, 1000, 3162]] * 2 and said.count("1.00") == 4 and "150" in said and "300" in said
    one = piles.Race(np.full(9, 0.5), 1.0, 2.0, (1.0, 0.1), (2.0, 0.2))
    races = {"discs": [(rival, one._replace(ours=2.0 if rival.ours else 3.0)) for rival in piles.PLANE]}
    piles.show(races, 100)
    assert "Hz" in capsys.readouterr().out
    assert [piles.our_settings(rival, "discs") for rival in piles.PLANE] == ["3 × 210 Hz", "1 × 70 Hz", "1 × 70 Hz",
                                                                             "2 × 140 Hz"]
    piles.draw(races, 100, tmp_path / "races.png")
    assert all((tmp_path / f"{name}.png").stat().st_size > 10_000 for name in ("growth", "races"))


@pytest.mark.long
@pytest.mark.parametrize("name", ["discs", "boxes"])
def test_a_pile_of_thirty_thousand_bodies_lands_without_bodies_that_pass_each_other(name):
    pile = piles.landed(piles.compiled_lesson(), name, 31_623)
    assert len(pile.state.contacts.a) > 1.5 * 31_623
    assert np.ptp(pile.state.x[:31_623, 1]) < piles.ROWS[2] * KINDS[name].pitch


def test_an_engine_whose_process_ends_is_named_and_the_others_are_timed(monkeypatch, capsys):
    one = piles.Race(np.full(9, 0.5), 1.0, 2.0, (1.0, 0.1), (2.0, 0.2))

    def ended(function, name, bodies, rival, rounds, threads):
        if rival is piles.PLANE[0]:
            raise BrokenProcessPool
        return one
    monkeypatch.setattr(piles, "alone", ended)
    monkeypatch.setattr(piles.Product, "installed", lambda product: True)
    assert [rival for rival, _ in piles.compare(["discs"], 100, 9)["discs"]] == list(piles.PLANE[1:])
    assert "pymunk" in capsys.readouterr().err


def test_only_engines_with_threads_are_compared_on_two(monkeypatch):
    asked = []
    monkeypatch.setattr(piles, "alone", lambda function, name, bodies, rival, rounds, threads: asked.append(
        (rival.product, threads)))
    monkeypatch.setattr(piles.Product, "installed", lambda product: True)
    piles.compare(["discs", "bricks"], 100, 9, 2)
    assert asked == [(piles.BOX2D, 2)] * 3 + [(piles.RAPIER, 2)] * 3


@pytest.mark.parametrize(("threads", "growth"), [(100_000, False), (2, True)])
def test_threads_that_are_not_there_or_not_timed_are_refused(monkeypatch, threads, growth):
    monkeypatch.setattr(piles.os, "cpu_count", lambda: 2)
    with pytest.raises(BadInput, match="--threads"):
        piles.measure(["spheres"], 100, 3, growth, False, threads=threads)


def test_a_pile_of_ten_thousand_is_no_higher_than_bodies_can_fall():
    rows = {name: 10_000 / max(kind.across, piles.across_in_rows(kind, 10_000)) ** (kind.d - 1)
            for name, kind in KINDS.items()}
    assert all(rows[name] <= 1.1 * piles.ROWS[kind.d] for name, kind in KINDS.items())
    assert all(piles.across_in_rows(kind, 900) <= kind.across for kind in KINDS.values())


@pytest.mark.long
@pytest.mark.parametrize("name", ["spheres", "bricks"])
def test_any_number_of_threads_gives_the_result_of_one_to_the_last_bit(name):
    from validate.speed.threads import on_threads
    lesson, kind = piles.compiled_lesson(), KINDS[name]._replace(across=5)
    one = piles.Ours(lesson, kind, *fallen(kind, 100))
    one.run(120)
    ends = []
    for advance in (lesson.advance_pile, on_threads(lesson, 1), on_threads(lesson, 2)):
        ends.append(advance(*one.shape, one.state, DT, 20, one.pile))
    assert len(ends[0].contacts.a) > 100
    for end in ends[1:]:
        assert all(np.array_equal(a, b) for a, b in zip(ends[0][:4], end[:4], strict=True))
        assert np.array_equal(ends[0].J, end.J) and np.array_equal(ends[0].contacts.gap, end.contacts.gap)
