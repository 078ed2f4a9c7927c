"""Wrong functions of stability cases: by default the first of each case, with --long all."""

import pytest


def wrong_functions(wrong):
    """Parameters of a test, from rows (slug of a case, name of a function, what is put in its place)."""
    seen = set()
    for k, (slug, name, function) in enumerate(wrong):
        yield pytest.param(slug, name, function, id=f"{slug}-{name}-{k}", marks=[pytest.mark.long] * (slug in seen))
        seen.add(slug)
