"""The pages of a report: every link leads somewhere, everything has a name, and numbers claim no more than is known."""

import json
import re
from html.parser import HTMLParser
from itertools import pairwise

import pytest

from validate import report
from validate.check import Verdict
from validate.measure import timing
from validate.measure.accuracy import theory
from validate.reference.contact_laws import MEASURED
from validate.report import films, numbers, plots, races, words
from validate.report.answers import answers, right
from validate.subject import modules

from .small_report import small_report

pytestmark = pytest.mark.xdist_group("coverage")          # a report has the table of coverage: made once

ADDRESSES = ("href", "src")


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """(folder, data) of a small report: a motion with an engine that follows its own law, numbers, a case, a map."""
    folder = tmp_path_factory.mktemp("report")
    data = small_report(("throw", "tensors"), ("thin-bodies", "amplification"))
    for name, text in report.texts(data["scenes"], data["stability"], data["run"]).items():
        (folder / name).write_bytes(text.encode())
    for plot, name, shown, _ in report.pictures(data["scenes"], data["stability"]):
        plots.draw(plot, folder / name, shown)
    return folder, data


class Page(HTMLParser):
    """The tags of a page, as (name, attributes), and the words between them."""

    def __init__(self, path):
        super().__init__()
        self.tags, self.text = [], ""
        self.feed(path.read_text(encoding="utf-8"))
        self.ids = {one["id"] for _, one in self.tags if "id" in one}

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data):
        if self.tags and self.tags[-1][0] not in ("script", "style"):
            self.text += data

    def all(self, *names):
        return [attributes for tag, attributes in self.tags if tag in names]


@pytest.fixture(scope="module")
def pages(made):
    return {path.name: Page(path) for path in made[0].glob("*.html")}


def test_a_report_consists_of_the_files_that_it_names(made):
    folder, data = made
    assert {path.name for path in folder.iterdir()} == report.files(data["scenes"], data["stability"])


def test_a_quick_report_names_the_stability_cases_that_it_leaves_to_a_full_one(made, pages):
    left = ["A million steps of a planet", "Limit of prediction of a double pendulum"]
    assert made[1]["run"]["left_to_full"] == left
    assert f"because each takes seconds: {'; '.join(left)}." in pages["index.html"].text


def test_every_link_leads_to_a_file_or_a_heading_of_the_report_and_none_leaves_it(made, pages):
    folder, _ = made
    for name, page in pages.items():
        for address in [one[key] for _, one in page.tags for key in ADDRESSES if key in one]:
            if address.startswith("data:"):
                continue
            file, _, anchor = address.partition("#")
            assert not file or (folder / file).is_file(), f"{name}: {address}"
            assert not anchor or anchor in pages[file or name].ids, f"{name}: {address}"
    for name in ("report.css", "style.css", "dark.css", "report.js", "player.js"):
        assert "://" not in (folder / name).read_text(encoding="utf-8"), name


def test_every_page_has_one_main_part_headings_with_names_in_order_and_tables_with_headers(pages):
    for name, page in pages.items():
        levels = [int(tag[1]) for tag, _ in page.tags if re.fullmatch("h[1-6]", tag)]
        assert len(page.all("main")) == 1 and levels[0] == 1 and levels.count(1) == 1, name
        assert all(deeper - level <= 1 for level, deeper in pairwise(levels)), (name, levels)
        assert all("id" in one for one in page.all("h1", "h2", "h3")), name
        assert len(page.ids) == sum("id" in one for _, one in page.tags), f"{name}: an id stands twice"
        assert all(one.get("scope") for one in page.all("th")), name
        assert all("tabindex" in one for one in page.all("div") if one.get("class") == "scroll"), name


def test_every_picture_is_described_and_has_its_data_beside_it(made, pages):
    for name, page in pages.items():
        for picture in page.all("img"):
            assert len(picture["alt"].split()) > 8, (name, picture)
        links = {one.get("href") for one in page.all("a")}
        for picture in page.all("img"):
            base = picture["src"].removesuffix(".svg")
            assert links & {f"{base}.csv", f"{base.removesuffix('-steps')}-runs.csv"}, (name, base)
        assert all(one.get("aria-label") for one in page.all("canvas")), name


def test_a_table_of_numbers_says_what_the_report_holds(made):
    folder, data = made
    runs = sum(len(c["rows"]) for s in data["scenes"][:1] for case in s["cases"].values()
               for c in case["ours"] + case["engines"])
    assert len((folder / "throw-runs.csv").read_text(encoding="utf-8").splitlines()) == runs + 1
    rows = (folder / "stability-integrators-amplification.csv").read_text(encoding="utf-8").splitlines()
    assert len(rows) == 6 * 120 + 1 and {len(row.split(",")) for row in rows} == {122}


def test_the_counts_of_our_methods_add_up_where_there_is_every_verdict():
    curve = {"order": None, "expected": 1, "label": "Euler", "rows": [], "measured": "", "reference": False}
    kinds = [verdict for verdict in Verdict if verdict is not Verdict.REFERENCE]               # which engines have only
    cases = {str(verdict): {"ours": [{**curve, "verdict": verdict}], "engines": []} for verdict in kinds}
    found = right([{"scene": "throw", "title": "Throw", "agreed": False, "cases": cases}], [])
    counts = [found[name] for name in ("agree", "predicted", "depart", "by_laws", "waiting", "undecided")]
    assert sum(counts) + len(found["unfinished"]) == found["runs"] == len(kinds)


def test_the_front_page_answers_four_questions_and_says_what_each_verdict_means(made, pages):
    folder, data = made
    front = pages["index.html"]
    assert {"right", "faster", "where", "stable", "legend"} <= front.ids
    assert all(verdict.value in front.text for verdict in Verdict)
    found = answers(data["scenes"], data["stability"])
    ours = [c for s in data["scenes"] for case in s["cases"].values() for c in case["ours"]]
    assert found["right"]["runs"] == len(ours)
    assert f"{len(ours)} of {len(ours)} comparisons that theory judges come out as it says" in front.text
    curves = {(s["scene"], c["label"]): any(row["predicted"] for row in c["rows"]) for s in data["scenes"]
              for case in s["cases"].values() for c in case["ours"] + case["engines"]}
    assert f"For {sum(curves.values())} of {len(curves)} curves, theory predicts the error itself" in front.text
    assert found["stable"]["hold"] == found["stable"]["findings"] > 0
    assert {line["engine"] for line in found["departures"]["lines"]} >= {"pybullet, default", "pymunk, Segment"}
    assert (folder / "index.html").stat().st_size < 100_000


def test_a_departure_that_no_scene_predicted_is_on_the_front_page(made):
    _, data = made
    worse = json.loads(json.dumps(data["scenes"]))
    worse[0]["cases"]["thrown"]["ours"][0].update(verdict="departs", message="is off")
    worse[0]["cases"]["thrown"]["engines"][0].update(verdict="departs", message="is off")
    found = answers(worse, [])
    assert found["right"]["depart"] == 1 and found["right"]["wrong"] == {"throw": "Throw"}
    assert found["departures"]["lines"][0]["kind"] == "departs"
    front = report.texts(worse, [], data["run"])["index.html"]
    assert "not always as predicted" in front and "comparisons depart" in front


def changed(made, **fields):
    """The results of the small report, of which these curves of ours in `throw` are changed; and what it was made with.
    """
    _, data = made
    other = json.loads(json.dumps(data))
    for curve in other["scenes"][0]["cases"]["thrown"]["engines"] if fields.pop("engines", False) else \
            other["scenes"][0]["cases"]["thrown"]["ours"][:1]:
        curve.update(fields)
    return other


def front_of(data):
    return report.texts(data["scenes"], data["stability"], data["run"])["index.html"]


def test_a_method_that_does_not_arrive_is_counted_on_the_front_page_and_not_among_those_that_agree(made):
    front = front_of(changed(made, verdict="does not arrive", rows=[], message="it never ends"))
    _, data = made
    ours = sum(len(case["ours"]) for scene in data["scenes"] for case in scene["cases"].values())
    assert f"{ours - 1} of {ours - 1} comparisons that theory judges come out as it says" in front
    assert re.search(r"1 does not arrive: <a href=\"throw.html\">Throw</a>", front)


def test_the_front_page_says_which_truths_are_an_engines_own_run(made):
    _, data = made
    assert "No truth is a run of an engine." in front_of(data)
    front = front_of(changed(made, engines=True, verdict="reference", reference=True))
    assert "In 1 scene the truth is an engine's own run, and that engine is not judged there: " \
           '<a href="throw.html">Throw</a> (pymunk)' in front
    assert "that is neither" not in front


def test_a_finding_that_was_not_run_is_counted_as_such(made):
    _, data = made
    other = json.loads(json.dumps(data))
    other["stability"][0]["not_run"] = [{"claim": "It holds.", "quantity": "share [-]", "why": "pybullet is missing"}]
    pages = report.texts(other["scenes"], other["stability"], other["run"])
    assert "findings hold; 1 not run" in pages["index.html"] and "pybullet is missing" in pages["stability.html"]
    assert "It holds.,share [-],,,,not run,pybullet is missing," in pages["stability.csv"]


def test_a_measured_limit_is_listed_and_counted(made):
    _, data = made
    assert words.measured_limits(data["scenes"], data["stability"]) == []
    other = changed(made, measured="ten times what was seen")
    found, = words.measured_limits(other["scenes"], other["stability"])
    assert found == (f"throw: {other['scenes'][0]['cases']['thrown']['ours'][0]['label']}", "ten times what was seen")
    assert "1 limit or tolerance was measured" in front_of(other)
    (quantity, why), *_ = MEASURED.items()
    other = changed(made, laws=[{"quantity": quantity, "known": 0.05}, {"quantity": quantity, "known": None}])
    assert words.measured_limits(other["scenes"], other["stability"]) == [(f"laws of contact: {quantity}", why)]


def test_a_quick_report_shows_no_tick_while_races_are_undecided_and_the_last_full_run_beside_it(made):
    _, data = made
    data = {**data, "run": {**data["run"], "full_run": None}}
    section = front_of(data).partition('id="faster"')[2].partition("</section>")[0]
    assert "verdict agrees" not in section and "verdict open" in section
    assert "No full run of this version is kept" in section
    counts = races.counted([])
    counts[1].update(ratio=31.0, low=28.0, high=35.0, slower=2, tie=5, races=55)
    other = json.loads(json.dumps(data))
    assert section.count("<div>") == section.count("</div>") == 1           # a grid has room for three parts only
    other["run"]["full_run"] = {"date": "2026-11-30", "commit": "abc1234", "machine": "Linux", "processor": "P",
                                "counts": counts}
    section = front_of(other).partition('id="faster"')[2].partition("</section>")[0]
    assert "2026-11-30" in section and "abc1234" in section and "31× (25 to 38) at 1 %, 2 losses and 5 ties" in section


@pytest.mark.parametrize(("ratio", "mark"), [(5000.0, " beyond"), (0.01, " below"), (50.0, "")])
def test_a_value_beyond_the_axis_of_the_strip_is_marked_as_such(made, ratio, mark):
    _, data = made
    other = json.loads(json.dumps(data))
    race = next(one for one in other["scenes"][0]["times"]["races"] if one["level"] == 0.01)
    race.update(ratio=ratio, low=0.9 * ratio, high=1.1 * ratio, outcome="faster", why="")
    dots = re.findall(r'class="dot \w+([ \w]*)" href="throw.html"', front_of(other))
    assert dots == [mark]
    assert ("Beyond the axis" in front_of(other)) == bool(mark)


def test_every_race_is_in_its_file_with_what_it_is_made_of(made):
    folder, data = made
    lines = (folder / "races.csv").read_text(encoding="utf-8").splitlines()
    held = sum(len(scene["times"]["races"]) for scene in data["scenes"])
    assert len(lines) == held + 1 and held % 4 == 0 and held > 0
    for name in ("order", "loop", "calls", "compilation, cold", "motion until compilation has paid"):
        assert name in lines[0]


def test_the_error_from_an_engines_own_law_is_drawn_beside_that_from_the_truth(made):
    folder, data = made
    curve = next(c for c in data["scenes"][0]["cases"]["thrown"]["engines"] if "own_law" in c)
    finest = words.own_errors(curve)[-1][1]
    assert finest < 0.1 * curve["rows"][-1]["error"]
    assert f"{curve['label']}, from its own law" in (folder / "throw-steps.svg").read_text(encoding="utf-8")


def test_the_film_of_a_scene_is_exact_enough_to_be_magnified(made):
    _, data = made
    picture = data["scenes"][0]["picture"]
    text = films.script(data["scenes"][0])
    film = json.loads(text.partition(" = ")[2].rstrip(";\n"))
    frames = picture["films"][0]["frames"]
    assert film["films"][0]["points"] == len(frames[0])
    assert len(film["films"][0]["frames"]) == 4 * -(-4 * 2 * len(frames) * len(frames[0]) // 3)


def test_a_plot_follows_the_scheme_of_the_page_and_has_no_background(made):
    text = (made[0] / "throw-times.svg").read_text(encoding="utf-8")
    assert "prefers-color-scheme: dark" in text and "var(--c-000000, #000000)" in text
    assert "style=\"fill: var(--c-ffffff" not in text


@pytest.mark.parametrize(("x", "said"), [(266.4, "270×"), (3.84, "3.8×"), (0.0423, "0.042×"), (None, "–")])
def test_a_ratio_has_two_digits(x, said):
    assert numbers.factor(x) == said


@pytest.mark.parametrize(("x", "tolerance", "said"), [
    (2.8284271, 3e-5, "2.82843"), (14400.0, 0.0, "14,400"), (1.0000005, 1e-13, "1.0000005000000"), (0.0, 1e-6, "0")])
def test_a_finding_has_as_many_digits_as_its_tolerance(x, tolerance, said):
    assert numbers.known(x, tolerance) == said


def test_a_busy_machine_is_named_and_an_idle_one_is_not():
    def run(others, load):
        return [{"times": {"others": others, "load": [load, 0.0, 0.0]}}]
    assert "used up to 1.2 of its 2 cores" in words.busy_warning(run(1.2, 1.0), 2)
    assert words.busy_warning(run(0.05, 3.0), 2) == ""               # the load is that of the minute before
    assert "load was up to 3.0" in words.busy_warning(run(None, 3.0), 2)
    assert words.busy_warning(run(None, 1.1), 2) == ""


def test_what_others_use_of_the_machine_is_what_remains_of_all_work():
    assert timing.used_by_others((0.0, 10.0, 5.0), (2.0, 13.0, 6.0)) == 1.0
    assert timing.used_by_others((0.0, 10.0, 5.0), (2.0, 10.9, 6.0)) == 0.0
    assert timing.used_by_others(None, None) is None
    assert timing.used_by_others((0.0, 0.0, 0.0), (0.01, 1.0, 0.0)) is None


def test_texts_of_the_source_flow():
    text = "Return the law of\na ball.  It falls:\n\n    v' = g\n\ndisc   rolls\n       on\nbox    slides\nFrom a book."
    assert words.flowing(text) == [
        ("text", "law of a ball. It falls:"), ("formula", "v' = g"),
        ("terms", [("disc", "rolls on"), ("box", "slides")]), ("text", "From a book.")]
    assert words.flowing("Return a (n, 3) of (0, 0, 1).") == [("text", "a of (0, 0, 1).")]
    assert str(words.subscripts("v_n < 1")) == "v<sub>n</sub> &lt; 1"


def test_no_page_names_what_only_a_programmer_knows():
    internal = re.compile(r"\b(?:[A-Z]{2,}_[A-Z_]+|[a-z]{4,}_[a-z_]{4,})\b")
    for name in modules.scene_names():
        scene = modules.bind_scene(name)
        for text in (*map(modules.report_text, filter(None, (scene.truth, scene.law))), theory(scene)):
            assert not internal.findall(text), name


def test_a_legend_of_fourteen_lines_is_lower_than_its_plot_and_no_wider():
    short, long = ["gyroscopic, implicit: 1.00"] * 7, ["pybullet, reduced coordinates: 1.00"] * 7
    assert plots.columns_of([*short, *long], 8) == 2 and plots.LINE * 8 / 9 * 8 < 0.5 * plots.HEIGHT
    assert plots.columns_of([*long, *long], 8) == 1 and plots.columns_of(["Euler: 1.00"] * 6, 9) == 3


@pytest.mark.parametrize(("curve", "predicted", "allowed"), [
    ({"rows": []}, "–", "–"),
    ({"rows": [{"predicted": None, "limit": 0.02, "band": None}]}, "–", "≤ 0.02"),
    ({"rows": [{"predicted": None, "limit": None, "band": None}]}, "–", "–"),
    ({"rows": [{"predicted": [1.1], "limit": 0.11, "band": 0.01}]}, "0.1", "± 0.01")])
def test_a_row_shows_the_error_that_theory_predicts_and_how_far_it_may_be_off(curve, predicted, allowed):
    assert words.theory_of(curve, [1.0]) == {"predicted": predicted, "allowed": allowed}


@pytest.mark.parametrize(("x", "digits", "shown"), [
    (126.0, 2, "130"), (99.6, 2, "100"), (300.0, 2, "300"), (9999.0, 2, "10000"), (0.5, 2, "0.5"), (999.9, 3, "1000")])
def test_a_number_between_a_hundredth_and_ten_thousand_has_no_exponent(x, digits, shown):
    assert numbers.number(x, digits) == shown
