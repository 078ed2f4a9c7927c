"""The command that measures speed and memory says by its exit code whether all requirements are met."""

import pytest

from validate.speed import benchmark


@pytest.mark.parametrize(("met", "code"), [((True, True), 0), ((True, False), 1), ((False, False), 1), ((), 0)])
def test_a_requirement_that_is_not_met_ends_with_1(met, code, capsys):
    parts = [lambda one=one: [("a step", "at least 10×", "9×", one)] for one in met]
    assert benchmark.measured(parts) == code
    assert capsys.readouterr().out.count("not met") == met.count(False)
