"""The records of the engines."""

import pytest

from solutions.checks import BadInput
from validate.engines.products import PRODUCTS, product_named

installed = pytest.mark.parametrize("product", [p for p in PRODUCTS if p.installed()], ids=str)


@installed
def test_an_adapter_has_an_empty_world_and_the_engines_switches(product):
    world = product.adapter.empty_world()
    for _ in range(3):
        world.step()
    world.close()
    parts = [switch.part for switch in product.adapter.SWITCHES]
    assert len(set(parts)) == len(parts)


def test_no_two_engines_have_one_name_colour_or_marker():
    for field in ("name", "colour", "marker", "distribution"):
        assert len({getattr(product, field) for product in PRODUCTS}) == len(PRODUCTS), field


def test_an_unknown_engine_is_refused_and_the_known_ones_are_named():
    assert product_named("pymunk") is PRODUCTS[0]
    with pytest.raises(BadInput, match=r"bullet3.*pymunk, pybullet, mujoco"):
        product_named("bullet3")
