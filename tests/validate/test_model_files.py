"""A Model as a file: it comes back to the last bit, and a wrong file gets one sentence."""

import json

import numpy as np
import pytest

from solutions.checks import BadInput
from solutions.support.model import (
    WORLD,
    BallJoint,
    Body,
    Distance,
    Drag,
    Hinge,
    Spring,
    Weld,
    make_model,
)
from solutions.support.shapes import Ball, Box, Capsule, HalfSpace, Polygon
from validate.worlds.model_files import model_schema, read_model, save_model

THIRD = 1.0 / 3.0
PLANE = make_model(
    [Body((THIRD, -0.0), 0.1 + 0.2, Ball(np.pi), THIRD, 0.7, 1e-300, (1e300, 5e-324), -THIRD),
     Body((2.0, 0.0), 1.0, Box((0.1, 0.2)), inertia=np.inf), Body((3.0, 0.0), 1.0, Capsule(0.1, 0.2), mu=np.inf),
     Body((4.0, 0.0), 1.0, Polygon(((-0.3, -0.2), (0.3, -0.2), (0.0, 0.4)))), Body((5.0, 0.0), 2.0, inertia=0.3),
     Body((0.0, 0.0), shape=HalfSpace((0.6, 0.8), THIRD), v=(0.8, -0.6))], (0.0, -9.81),
    [Hinge(0, WORLD, (THIRD, 0.0)), Weld(1, 2, (2.5, 0.0)), Distance(3, 4, (0.0, 0.1), (0.0, 0.2), THIRD)],
    [Spring(0, WORLD, (0.0, 0.0), (1.0, THIRD), 1.0, 1e5, 0.1)], [Drag(THIRD)])
HALF = np.sqrt(0.5)
SPACE = make_model(
    [Body((0.0, 0.0, 0.0), 1.0, Box((0.1, 0.2, 0.3)), q=(HALF, 0.0, 0.0, HALF), omega=(1.0, 2.0, 3.0)),
     Body((1.0, 0.0, 0.0), 1.0, inertia=(1.0, 1.5, 2.0)), Body((2.0, 0.0, 0.0), 1.0, Ball(0.1))], (0.0, 0.0, -1.0),
    [Hinge(0, WORLD, (0.0, 0.0, 0.0), (0.0, 0.6, 0.8)), BallJoint(1, 0, (0.5, 0.0, 0.0))])


def bits(value):
    """Numbers as text with all their digits, and records by name: what == confuses (0.0 and −0.0) is told apart."""
    return repr(value)


@pytest.mark.parametrize("model", [PLANE, SPACE], ids=["plane", "space"])
def test_a_model_comes_back_to_the_last_bit(tmp_path, model):
    path = tmp_path / "model.json"
    save_model(model, path)
    assert bits(read_model(path)) == bits(model)
    first = path.read_text()
    save_model(read_model(path), path)
    assert path.read_text() == first
    assert "Infinity" not in first and "NaN" not in first


def test_a_model_that_was_not_checked_is_checked_when_it_is_saved(tmp_path):
    with pytest.raises(BadInput, match="mass"):
        save_model(PLANE._replace(bodies=(Body((0.0, 0.0), -1.0),)), tmp_path / "model.json")
    assert not list(tmp_path.iterdir())


def test_what_make_model_fills_in_is_left_out(tmp_path):
    path = tmp_path / "model.json"
    save_model(make_model([Body((0.0, 1.0), 2.0, Ball(0.5)), Body((0.0, 0.0), shape=HalfSpace((0.0, 1.0)))],
                          (0.0, -9.81)), path)
    assert json.loads(path.read_text()) == {
        "gravity": [0.0, -9.81],
        "bodies": [{"x": [0.0, 1.0], "m": 2.0, "shape": {"kind": "Ball", "radius": 0.5}},
                   {"x": [0.0, 0.0], "shape": {"kind": "HalfSpace", "normal": [0.0, 1.0]}}]}


def test_the_schema_allows_what_is_saved_and_refuses_what_reading_refuses(tmp_path):
    schemas = pytest.importorskip("jsonschema")
    judge = schemas.Draft202012Validator(model_schema())
    schemas.Draft202012Validator.check_schema(model_schema())
    for model in (PLANE, SPACE):
        save_model(model, tmp_path / "model.json")
        judge.validate(json.loads((tmp_path / "model.json").read_text()))
    for change, _ in WRONG:
        data = saved(tmp_path)
        change(data)
        assert not judge.is_valid(data), data


def saved(tmp_path):
    save_model(PLANE, tmp_path / "model.json")
    return json.loads((tmp_path / "model.json").read_text())


WRONG = [                    # (a change of a right file, words of the sentence)
    (lambda data: data.update(gravities=[]), "'gravities' of a model is unknown"),
    (lambda data: data.pop("gravity"), "'gravity' of a model is missing"),
    (lambda data: data.update(bodies={}), "bodies is dict: give a list"),
    (lambda data: data["bodies"].append(3), "body 6 is int"),
    (lambda data: data["bodies"][1].update(mass=1.0), "'mass' of body 1 is unknown"),
    (lambda data: data["bodies"][1].update(m="heavy"), "m of body 1 is 'heavy'"),
    (lambda data: data["bodies"][1].update(m=True), "m of body 1 is True"),
    (lambda data: data["bodies"][1].update(m=None), "m of body 1 is None"),
    (lambda data: data["bodies"][1].update(x=0.0), "x of body 1 is 0.0"),
    (lambda data: data["bodies"][1].update(x=[0.0, "0"]), "an entry of x of body 1 is '0'"),
    (lambda data: data["bodies"][1].pop("x"), "'x' of body 1 is missing"),
    (lambda data: data["bodies"][1]["shape"].update(kind="Cone"), "kind of shape of body 1 is 'Cone'"),
    (lambda data: data["bodies"][1]["shape"].pop("kind"), "kind of shape of body 1 is None"),
    (lambda data: data["bodies"][1]["shape"].update(radius=1.0), "'radius' of shape of body 1 is unknown"),
    (lambda data: data["joints"][0].update(a=0.5), "a of joint 0 is 0.5"),
    (lambda data: data["joints"][0].update(kind="Ball"), "kind of joint 0 is 'Ball'"),
    (lambda data: data["loads"][0].update(k=[1.0]), "k of load 0 is"),
]


@pytest.mark.parametrize(("change", "words"), WRONG, ids=[words for _, words in WRONG])
def test_a_wrong_file_gets_one_sentence(tmp_path, change, words):
    data = saved(tmp_path)
    change(data)
    (tmp_path / "wrong.json").write_text(json.dumps(data))
    with pytest.raises(BadInput) as error:
        read_model(tmp_path / "wrong.json")
    assert words in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize(("text", "words"), [
    ("{", "not JSON"), ("[" * 100000, "not JSON"), ("3", "a model is int"),
    ('{"bodies": [], "gravity": [NaN, 0]}', "NaN"), ('{"bodies": [], "gravity": [0, 0]}', "at least one")])
def test_a_file_that_is_no_model_gets_one_sentence(tmp_path, text, words):
    (tmp_path / "wrong.json").write_text(text)
    with pytest.raises(BadInput, match=words):
        read_model(tmp_path / "wrong.json")


def test_a_file_that_is_not_there_and_one_of_bytes_get_one_sentence(tmp_path):
    with pytest.raises(BadInput, match="No such file"):
        read_model(tmp_path / "nowhere.json")
    (tmp_path / "bytes.json").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(BadInput, match="not JSON"):
        read_model(tmp_path / "bytes.json")


def test_what_is_no_model_is_not_saved(tmp_path):
    with pytest.raises(BadInput, match="the model"):
        save_model(3, tmp_path / "scene.json")


@pytest.mark.parametrize("path", [None, 3, ["model.json"], b"model.json"])
def test_what_names_no_file_gets_one_sentence(path):
    with pytest.raises(BadInput, match="the name of a file"):
        save_model(PLANE, path)
    with pytest.raises(BadInput, match="the name of a file"):
        read_model(path)


def test_a_load_that_is_a_function_is_not_saved(tmp_path):
    model = make_model([Body((0.0, 0.0), 1.0)], (0.0, 0.0), loads=[Drag(1.0), lambda t, x, q, v, omega: (v, omega)])
    with pytest.raises(BadInput, match="load 1 is a function"):
        save_model(model, tmp_path / "model.json")


@pytest.mark.parametrize(("text", "words"), [
    ('{"gravity": [0, 1e999], "bodies": []}', "a number is 1e999"),
    ('{"gravity": [0, 1' + 400 * "0" + '], "bodies": []}', "a number is 1000.* with 401 characters"),
    ('{"gravity": [0, 1], "bodies": [], "gravity": [0, 2]}', "'gravity' of an object is given twice"),
    ('{"gravity": ' + 900 * "[" + 900 * "]" + ', "bodies": []}', "not JSON .*recursion"),
], ids=["infinite", "long", "twice", "deep"])
def test_what_is_read_is_what_is_written(tmp_path, text, words):
    """Python's own reader takes a number that is too large as infinite, and the last of two fields of one name."""
    (tmp_path / "model.json").write_text(text, encoding="utf-8")
    with pytest.raises(BadInput, match=words):
        read_model(tmp_path / "model.json")


def test_a_file_that_cannot_be_written_gets_one_sentence(tmp_path):
    with pytest.raises(BadInput, match="name a file that can be written"):
        save_model(PLANE, tmp_path / "nowhere" / "model.json")
