"""`validate limits` says how sharp the limits of a report are."""

import json

import numpy as np
import pytest

from solutions.checks import BadInput
from validate import methods
from validate.reference import schemes
from validate.reference.schemes import ErrorLaw, Tableau, advance, advance_linear, advance_modes
from validate.report import limits
from validate.run.store import FORMAT

TABLES = {name: table for name, table in vars(schemes).items() if isinstance(table, Tableau)}


def report(*rows, label="Euler"):
    """rows: (limit, error, predicted, band)."""
    stored = [{"steps": n, "limit": limit, "failure": None, "observed": [1.0 + error], "predicted": predicted,
               "band": band} for n, (limit, error, predicted, band) in enumerate(rows, 1)]
    scene = {"scene": "throw", "lesson": "integrators",
             "cases": {"thrown": {"truth": [1.0], "ours": [{"label": label, "rows": stored}], "engines": []}}}
    return {"run": {"format": FORMAT}, "scenes": [scene], "stability": []}


ONE_SIDED, TWO_SIDED = (0.1, 0.01, None, None), (0.11, 0.1, [1.1], 0.01)


def test_a_row_is_judged_by_its_limit_or_by_its_band_and_round_off_does_not_count():
    rows = list(limits.rows_of(report(ONE_SIDED, (1e-12, 1e-15, None, None), (0.6, 0.1, None, None), TWO_SIDED)))
    assert [round(row.slack, 6) for row in rows] == [10.0, 0.1] and [row.two_sided for row in rows] == [False, True]


def test_the_three_numbers_are_those_of_their_own_rows():
    rows = list(limits.rows_of(report(ONE_SIDED, TWO_SIDED, TWO_SIDED, TWO_SIDED)))
    assert limits.three(rows) == ["75%", "0.1", "0.1", "0.1", "10", "10", "10"]
    assert limits.three(rows[:1]) == ["0%", "–", "–", "–", "10", "10", "10"]


def test_the_tables_name_the_loosest_curve_of_each_kind(tmp_path, capsys):
    content = report((0.1, 0.01, None, None), (0.1, 0.0, None, None), label="by a bound")
    content["scenes"] += report(TWO_SIDED, label="by a prediction")["scenes"]
    (tmp_path / "report.json").write_text(json.dumps(content))
    limits.show(tmp_path)
    shown = capsys.readouterr().out
    bound, predicted = shown.split("limit/error, least")[1].split("band/prediction, least")
    assert "integrators" in shown and "∞" in shown
    assert "by a bound" in bound and "by a prediction" not in bound and "by a prediction" in predicted


def test_a_report_of_round_off_only_is_refused(tmp_path):
    (tmp_path / "report.json").write_text(json.dumps(report((1e-12, 0.0, None, None))))
    with pytest.raises(BadInput, match="round-off"):
        limits.show(tmp_path)


@pytest.mark.parametrize(("method", "factor"), [
    (methods.EULER, lambda z: 1.0 + z), (methods.MIDPOINT, lambda z: 1.0 + z + z * z / 2.0),
    (methods.IMPLICIT_EULER, lambda z: 1.0 / (1.0 - z)),
    (methods.RK4, lambda z: 1.0 + z + z**2 / 2.0 + z**3 / 6.0 + z**4 / 24.0),
    (methods.IMPLICIT_MIDPOINT, lambda z: (1.0 + 0.5 * z) / (1.0 - 0.5 * z))],
    ids=lambda one: getattr(one, "label", ""))
def test_a_table_multiplies_a_decay_by_its_stability_function(method, factor):
    """Of v̇ = −2v one step keeps R(−2h).  *Source:* Hairer and Wanner 1996, IV.3."""
    v = advance(method.table, lambda t, x, v: -2.0 * v, 0.0, 1.0, 0.1, 7)[1]
    assert v == pytest.approx(factor(-0.2) ** 7, rel=1e-14)


@pytest.mark.parametrize("name", TABLES)
def test_modes_that_do_not_touch_are_run_by_the_power_of_a_matrix(name):
    omega, c, x, v = np.array(((0.5, 3.0, 7.0), (0.1, 0.0, 2.0), (1.0, -2.0, 0.5), (0.0, 4.0, -3.0)))
    law = lambda t, x, v: -omega**2 * x - c * v
    for steps in (1, 2, 37):
        one_by_one, at_once = (march(TABLES[name], law, x, v, 0.02, steps) for march in (advance, advance_modes))
        assert np.allclose(at_once, one_by_one, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("name", TABLES)
def test_a_linear_law_is_run_by_the_power_of_a_matrix(name):
    K, C, g = np.array(((2.0, -1.0), (0.5, 3.0))), np.array(((0.1, 0.3), (0.0, 0.2))), np.array((0.4, -9.81))
    for law, x, v in ((lambda t, x, v: g - K @ x - C @ v, np.array((1.0, 2.0)), np.array((0.0, -3.0))),
                      (lambda t, x, v: -9.81j - (2.0 + 1.0j) * x - 0.1 * v, 0.5 + 0.0j, 1.0j)):
        for steps in (1, 2, 37):
            one_by_one, at_once = (march(TABLES[name], law, x, v, 0.02, steps) for march in (advance, advance_linear))
            assert np.allclose(at_once, one_by_one, rtol=1e-13, atol=1e-13)


def test_an_expansion_says_how_far_it_can_be_trusted():
    law = ErrorLaw(lambda steps, nudge: [1.0 + 3.0 / steps + 5.0 / steps**2 + 7.0 / steps**3 + 1e3 / steps**4],
                   np.array([1.0]), 1, 1.0, 400)
    found, true = law.prediction(1e-4, 0.0), 3e-4 + 5e-8 + 7e-12 + 1e-13
    assert abs(found.error[0] - true) <= found.band < 0.02 * true
