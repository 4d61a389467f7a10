"""A report of one's own recordings: the answer first, nothing of the paper, a class in one table that sorts."""

import base64
import dataclasses
import json
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from markupsafe import Markup

import swingdown
from swingdown.arrays import Shown
from swingdown.engine.trajectory import simulate
from swingdown.pendulum.model import Model
from swingdown.planning.settings import complete
from swingdown.plots import save
from swingdown.report import contents, page
from swingdown.report.trace import MOST, trace
from swingdown.studies.pendulums import in_order, pendulums

TIMES = np.arange(1001) / 100
CAPTION = "Pendulums side by side."


def answered(name, frequency, seed):
    """The answer on a viscous pendulum, its table and verdict under the name of its campaign."""
    model = Model("viscous", {"natural_frequency": frequency, "viscous_ratio": 0.008})
    angle = simulate(model, TIMES, 0.3) + 0.002 * np.random.default_rng(seed).standard_normal(TIMES.size)
    found = swingdown.explain(TIMES, angle, base=["viscous"], rounds=0, fitted=["viscous"], names=[name])
    verdict = dict(found.verdict) | {"campaign": name}
    table = found.table.assign(campaign=name, label=name.replace("-", " "), verdict=verdict["status"])
    return found, table, verdict


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A function that makes the Material of so many pendulums, with pictures, and the folder of its report."""
    folder = tmp_path_factory.mktemp("results")
    answers = [answered(f"swing-{k}", 5.0 + 0.5 * k, k) for k in (1, 2, 10, 3)]

    def material(count, emulated="no"):
        chosen, seen = answers[:count], []
        for found, _, verdict in chosen:
            for name in ("answer", "map", "gap"):
                path = folder / "discovery" / verdict["campaign"] / "figures" / f"{name}.svg"
                path.parent.mkdir(parents=True, exist_ok=True)
                if not path.exists():
                    save(found.plot(), path)
                seen.append(str(path))
        why = {"problem": "lots is no number", "mend": "mend the file", "left_out_of": "everything"}
        out = pd.DataFrame([{"file": "../broken.csv", "campaign": "broken", "recording": "broken"} | why])
        refused = pendulums(answers[0][0].fits, left_out=out).iloc[1:]
        table = in_order(pd.concat([*(table for _, table, _ in chosen), refused], ignore_index=True))
        table.loc[table["verdict"] != "refused", "emulated"] = emulated
        recordings = [
            {"recording": v["campaign"], "campaign": v["campaign"], "file": f"../{v['campaign'].replace('-', ' ')}.csv", "role": "",
             "emulated": emulated, "sha256": "0" * 64, "taken": "took `a` as degrees"}
            for _, _, v in chosen
        ]  # fmt: skip
        settings = complete({"recordings": "recordings.csv", "simulation": {"simulated": []}})
        figures = {"pendulums": (seen[0], CAPTION)}
        return contents.Material(
            {"pendulums": table, "left_out": out}, figures, recordings, settings, verdicts=[v for *_, v in chosen], seen=seen,
            swings={v["campaign"]: list(found.shown) for found, _, v in chosen},
        )  # fmt: skip

    return material, folder


def written(material, folder):
    sections = contents.sections(material)
    return page.write(folder / "report.html", sections, contents.head(material))


def plain(path):
    """The text of a page as a reader sees it, without pictures, styles and scripts."""
    text = re.sub(
        r"base64,[^\"]*|<style.*?</style>|<script.*?</script>",
        "",
        path.read_text(encoding="utf-8"),
        flags=re.DOTALL,
    )
    return re.sub(r"\s+", " ", re.sub(r"<[^>]+>", " ", text))


def test_it_opens_with_the_sentence_then_recording_quantities_torque_evidence_settings(made):
    material, folder = made
    text = plain(written(material(1), folder))
    order = ["What stops this pendulum?", "Air drag (viscous) stops it: T = ", "Nothing else is needed.", "Nothing is missing.", "How sure.",
             "Recording and fit, swing-1.", "Quantities, swing-1.", "decay time (1/e)", "What this run rests on", "Versions."]  # fmt: skip
    places = [text.rindex(words) for words in order]
    assert places == sorted(places)
    assert "1 recording was left out: broken." in text
    assert "broken broken ../broken.csv everything lots is no number mend the file" in text
    subtitle = contents.head(material(1)).subtitle
    assert subtitle == Markup("swing 1.csv (took <code>a</code> as degrees)") and isinstance(subtitle, Markup)
    shown = material(1).tables["pendulums"].iloc[0]
    assert f"T = {shown['period_s_text']} s, Q = {shown['quality_text']}." in text
    assert text.count(shown["period_s_text"]) == 2, "in the sentence, and in the table"


@pytest.mark.parametrize(("count", "named"), [(3, True), (4, False)])
def test_files_are_named_above_the_report_while_they_are_few(made, count, named):
    material, _ = made
    subtitle = contents.head(material(count)).subtitle
    assert [name for name in ("swing 1.csv", "swing 2.csv", "swing 10.csv") if name in subtitle] == [
        "swing 1.csv", "swing 2.csv", "swing 10.csv",
    ] * named  # fmt: skip
    assert ("4 recordings" in subtitle) is not named


def test_the_terminal_has_the_sentences_that_open_the_report_as_plain_text(made):
    material, _ = made
    told = contents.plain_findings(material(1))
    assert told[0].startswith("Air drag (viscous) stops it") and told[-1].startswith("Nothing is missing.")
    assert not any("<" in line or "&" in line for line in told)


def test_control_characters_of_a_name_are_shown_and_not_obeyed(made):
    """One turns the line round, another is no character of a page at all."""
    material, folder = made
    (one,) = material(1).recordings
    text = plain(
        written(dataclasses.replace(material(1), recordings=[one | {"file": "../a\u202eb\x0b.csv"}]), folder)
    )
    assert text.count("a\\u202eb\\x0b.csv") == 2 and not set(text) & set("\u202e\x0b")


def test_figures_that_have_nothing_to_say_are_left_out(made):
    """Where nothing was missing, and no move was made, there is no torque that is missing and no before and after."""
    material, folder = made
    found = material(1)
    assert {Path(path).stem for path in found.seen} == {"answer", "map", "gap"}
    labels = [
        item.label
        for section in contents.sections(found)
        for item in section.items
        if isinstance(item, page.Figure)
    ]
    assert labels == ["Recording and fit, swing-1"]
    groups = {"velocity": {"share": 0.5, "chi_square": 90.0, "freedom": 3, "p": 0.0}}
    (verdict,) = found.verdicts
    verdict = verdict | {"status": "unknown", "where": verdict["where"] | {"groups": groups}}
    gap = verdict["gap"] | {"fit": [2.0, 1.5], "holdout": [2.0, 1.6]}
    more = dataclasses.replace(found, verdicts=[verdict | {"gap": gap}])
    labels = [
        item.label
        for section in contents.sections(more)
        for item in section.items
        if isinstance(item, page.Figure)
    ]
    assert labels == ["Recording and fit, swing-1", "Missing torque, swing-1", "Gap, swing-1"]


@pytest.mark.parametrize("count", [1, 4])
def test_nothing_of_the_paper_is_in_it_and_it_is_small(made, count):
    material, folder = made
    path = written(material(count), folder)
    for words in (
        "paper",
        "Paper",
        "Table 2",
        "Table 3",
        "Figure",
        "published",
        "hidden_effects",
        "simulated",
    ):
        assert words not in plain(path), words
    assert path.stat().st_size < 2_000_000


def test_every_number_leads_to_its_file(made):
    material, folder = made
    found = material(1)
    text = written(found, folder).read_text(encoding="utf-8")
    links = set(re.findall(r'href="((?:tables|discovery|figures)/[^"]+)"', text))
    assert {
        "tables/pendulums.csv",
        "discovery/swing-1/verdict.json",
        "discovery/swing-1/figures/answer.svg",
    } <= links
    items = [item for section in contents.sections(found)[:-2] for item in section.items]
    assert all(item.link and item.rule for item in items if isinstance(item, page.Table | page.Figure))


def test_what_is_emulated_says_so_at_every_table_and_figure(made):
    material, folder = made
    for emulated, expected in (("yes", True), ("no", False)):
        found = material(1, emulated)
        sections = [one for one in contents.sections(found)[:-2] if one.title != "Recordings left out"]
        items = [item for section in sections for item in section.items]
        told = [getattr(item, "caption", "") for item in items if isinstance(item, page.Table | page.Figure)]
        assert told and all((contents.LABEL in text) is expected for text in told)
        assert ("emulated" in plain(written(found, folder))) is expected


def test_a_class_is_one_table_and_one_picture(made):
    material, folder = made
    found = material(4)
    (section, *_) = contents.sections(found)
    lead, table, picture = section.items
    assert lead.text == "4 pendulums. Nothing is missing: 4; 1 file could not be used."
    assert [str(row[0]).split(">")[-2].split("<")[0] for row in table.rows[:-1]] == [
        "swing 1",
        "swing 2",
        "swing 10",
        "swing 3",
    ]
    assert table.rows[-1][0] == "broken" and "lots is no number" in table.rows[-1][1]
    assert picture.text == CAPTION
    assert len(re.findall("<img", written(found, folder).read_text(encoding="utf-8"))) == 1


def test_the_papers_study_keeps_its_own(made):
    material, _ = made
    own = material(1)
    paper = dataclasses.replace(own, settings=complete({"recordings": "recordings.csv"}))
    titles = [section.title for section in contents.sections(paper)]
    assert titles[:3] == ["Findings", "Recordings left out", "What is missing"]


def test_in_a_browser_the_table_sorts_and_fits_a_phone_by_day_and_night(made, browser):
    material, folder = made
    path = written(material(4), folder)
    for width, scheme in ((1400, "light"), (390, "dark")):
        opened = browser.new_page(viewport={"width": width, "height": 900}, color_scheme=scheme)
        opened.goto(path.as_uri())
        assert opened.evaluate("document.documentElement.scrollWidth <= innerWidth"), width
        background = opened.evaluate("getComputedStyle(document.body).backgroundColor")
        assert (sum(map(int, re.findall(r"\d+", background)[:3])) < 200) is (scheme == "dark")

        def first_column(opened=opened):
            return opened.eval_on_selector_all(
                "table.sortable tbody td:first-child", "cells => cells.map(c => c.innerText)"
            )

        opened.click("table.sortable th >> text=period")
        assert first_column() == ["swing 10", "swing 3", "swing 2", "swing 1", "broken"]
        opened.click("table.sortable th >> text=period")
        assert first_column() == ["swing 1", "swing 2", "swing 3", "swing 10", "broken"]
        opened.close()
    one = browser.new_page(viewport={"width": 1400, "height": 900})
    one.goto(written(material(1), folder).as_uri())
    evidence = one.evaluate(
        "[...document.querySelectorAll('h2')].find(h => ['Evidence', 'Settings'].includes(h.innerText)).getBoundingClientRect().top"
    )
    assert evidence < 5 * 900


@pytest.mark.parametrize("width", [1400, 1000, 700, 390])
def test_a_caption_is_no_wider_than_what_is_seen_of_its_table(made, browser, width):
    material, folder = made
    opened = browser.new_page(viewport={"width": width, "height": 900})
    opened.goto(written(material(4), folder).as_uri())
    over = opened.eval_on_selector_all(
        ".scroll",
        "all => all.map(one => one.querySelector('caption').getBoundingClientRect().right - one.getBoundingClientRect().right)",
    )
    opened.close()
    assert over and max(over) < 1


def test_what_an_answer_rests_on_is_folded_away_until_it_is_asked_for_or_printed(made, browser):
    material, folder = made
    opened = browser.new_page()
    opened.goto(written(material(1), folder).as_uri())
    answer, versions = opened.locator("#quantities-swing-1"), opened.locator("#versions")
    assert answer.is_visible() and not versions.is_visible()
    opened.get_by_role("link", name="Versions").click()
    assert versions.is_visible() and not opened.locator("#settings pre").is_visible()
    opened.reload()  # with the place in its address
    assert versions.is_visible()
    opened.pdf()
    assert opened.locator("#settings pre").is_visible()
    opened.close()


def test_a_trace_can_be_looked_at_closely_and_is_a_picture_on_paper(made, browser):
    material, folder = made
    path = written(material(1), folder)
    for width, scheme in ((1400, "light"), (390, "dark")):
        opened = browser.new_page(viewport={"width": width, "height": 900}, color_scheme=scheme)
        wrong, asked = [], []
        opened.on("pageerror", lambda error, wrong=wrong: wrong.append(str(error)))
        opened.on("request", lambda request, asked=asked: asked.append(request.url))
        opened.goto(path.as_uri())
        figure = opened.locator("figure.zoomable")
        assert figure.count() == 1 and figure.locator("canvas").count() == 2
        assert not figure.locator("img").is_visible()
        assert opened.evaluate("document.documentElement.scrollWidth <= innerWidth"), width
        before, pictures = figure.locator(".u-axis").count(), []
        for button in ("closer", "closer", "all of it"):
            figure.get_by_role("button", name=button).click()
            pictures.append(figure.screenshot())
        assert before and len(set(pictures)) == 3, "each click shows another stretch"
        opened.emulate_media(media="print")
        assert figure.locator("img").is_visible() and not figure.locator("canvas").first.is_visible()
        assert not wrong and all(url.startswith(("file:", "data:")) for url in asked)
        opened.close()


def test_what_a_trace_holds_is_what_was_measured_and_fitted(made):
    material, _ = made
    (figure,) = [
        item for item in contents.sections(material(1))[0].items if getattr(item, "numbers", None) is not None
    ]
    (told,) = json.loads(figure.numbers)["recordings"]
    assert told["samples"] == told["kept"] == TIMES.size
    assert any(held for _, held in told["parts"]) and not all(held for _, held in told["parts"])
    shown = material(1).swings["swing-1"]
    for key, value in (("angle", [one.angle for one in shown]), ("fit", [one.fit for one in shown])):
        packed = np.frombuffer(base64.b64decode(told[key]), "<f4")
        np.testing.assert_allclose(packed, np.degrees(np.concatenate(value)), atol=1e-5)


def test_of_a_long_recording_what_stands_out_stays_and_the_page_stays_small():
    times = np.arange(400_000) / 1000
    angle = 0.3 * np.cos(7 * times)
    fit = angle.copy()
    fit[123_456] -= 0.1
    told = trace([Shown("long", "", times, angle, fit)], 0.001)
    assert len(told) < 400_000
    (one,) = json.loads(told)["recordings"]
    assert one["samples"] == 400_000 and 0 < one["kept"] <= MOST
    packed = [np.frombuffer(base64.b64decode(one[key]), "<f4") for key in ("time", "angle", "fit")]
    at = np.argmax(packed[1] - packed[2])
    assert packed[0][at] == pytest.approx(123.456) and (packed[1] - packed[2])[at] == pytest.approx(
        np.degrees(0.1), abs=1e-4
    )


def test_a_rate_is_called_a_rate():
    told = [
        json.loads(trace([Shown("a", "", TIMES, TIMES, TIMES)], 0.1, unit=unit)) for unit in ("rad", "rad/s")
    ]
    assert [one["what"] for one in told] == ["angle (°)", "angular rate (°/s)"]
    assert [one["left"] for one in told] == ["data − fit (°)", "data − fit (°/s)"]


def test_a_trace_with_room_for_every_sample_keeps_every_sample():
    """Where the fit leaves nothing, too, and no sample stands out."""
    told = json.loads(trace([Shown("a", "", TIMES, TIMES, TIMES)], 0.1, most=TIMES.size))
    assert told["recordings"][0]["kept"] == told["recordings"][0]["samples"] == TIMES.size


def test_names_in_a_trace_cannot_end_it():
    told = trace([Shown("</script><b>", "", TIMES[:9], TIMES[:9], TIMES[:9])], None)
    assert "<" not in told and json.loads(told)["recordings"][0]["name"] == "</script><b>"
