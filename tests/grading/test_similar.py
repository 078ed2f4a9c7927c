"""Copies are told as alike, with any text between their lines, and files of one's own are not."""

import re

import pytest

from validate.grading import example, similar
from validate.grading.submissions import Submission
from validate.subject import modules

LESSON = "integrators"
ADA = example.worked(LESSON).replace("x_new", "position_after").replace("np.zeros", "numpy_zeros")
MINE = '''
def euler_step(acceleration, t, x, v, dt, p):
    rate = acceleration(t, x, v, p)
    place = v * dt
    place += x
    rate *= dt
    return place, rate + v
'''


def told(**texts):
    """Return {student: names of the others that are told as alike}."""
    handed_in = [Submission(name, {LESSON: text.encode()}, (), "") for name, text in texts.items()]
    return {name: {other for _, other, _ in pairs} for name, pairs in similar.alike(handed_in, (LESSON,)).items()}


def with_lines(text, make):
    """Put a line that does nothing after every line of the answers that ends a statement."""
    handed_out = set((modules.ROOT / "lessons" / f"{LESSON}.py").read_text().splitlines())
    lines = []
    for number, line in enumerate(text.splitlines()):
        lines.append(line)
        inside = line.startswith("    ") and line not in handed_out
        if inside and not re.search(r"([,(\[{:\\]|and|or|\+)\s*(#.*)?$", line):
            lines.append(re.match(r"\s*", line)[0] + make(number))
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("make", [
    lambda n: f"_ = {1000 + n}", lambda n: "pass", lambda n: f"'{n}'", lambda n: f"unread_{n} = {n} * 2 - 1"],
    ids=["assignment", "pass", "text", "name that is never read"])
def test_a_copy_with_lines_that_do_nothing_is_told(make):
    eve = with_lines(ADA, make)
    assert eve.count("\n") > ADA.count("\n") + 20
    found = told(ada=ADA, eve=eve)
    assert "ada" in found["eve"]
    assert "eve" in found["ada"]


def test_a_copy_with_other_names_blanks_and_comments_is_told():
    eve = re.sub(r"\bk(\d)\b", r"slope_\1", ADA).replace(" + ", "  +  ").replace("    return", "    # done\n    return")
    assert "ada" in told(ada=ADA, eve=eve)["eve"]


def test_an_answer_of_ones_own_and_the_file_as_handed_out_are_not_told():
    handed_out = (modules.ROOT / "lessons" / f"{LESSON}.py").read_text()
    found = told(ada=ADA, bob=MINE, cy=handed_out, dia=handed_out)
    assert not found.get("bob") and not found.get("cy") and not found.get("dia")
