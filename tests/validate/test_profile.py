"""The profile of a step of a pile, for notebook 9."""

from validate.engines.contact import DT, KINDS, fallen
from validate.speed import piles, profile
from validate.subject import modules


def test_sweeps_are_most_of_a_step_at_rest(monkeypatch):
    """In plain Python, where every part takes long enough to be seen with one call."""
    monkeypatch.setattr(profile, "ROUNDS", 5)
    monkeypatch.setattr(profile, "CALLS", 1)
    monkeypatch.setattr(profile, "STEPS", 8)
    kind, lesson = KINDS["discs"]._replace(across=12), modules.bind("contact")
    pile = piles.Ours(lesson, kind, *fallen(kind, 12))
    pile.run(240)
    parts = profile.profile(lesson, pile.state, pile.pile, DT)
    costs = {part.name: part.times * part.call for part in parts}
    assert min(costs.values()) >= 0.0                    # a part that is too quick to be seen costs nothing
    assert max(costs, key=costs.get).startswith("velocity_sweep_2d")
    assert next(part for part in parts if "9.16" in part.name).times == 2 * pile.pile.substeps
    factors = profile.without_ideas(lesson, pile.state, pile.pile, DT, parts)
    assert len(factors) == 2 and min(factors.values()) > 0.0
