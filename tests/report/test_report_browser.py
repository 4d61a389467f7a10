"""The report in a real browser: every figure is drawn, the contents lead somewhere, nothing is fetched from outside."""

import pytest


@pytest.fixture(scope="module")
def page(browser, small_study):
    opened = browser.new_page(viewport={"width": 1280, "height": 900})
    opened.asked = []
    opened.on("request", lambda request: opened.asked.append(request.url))
    opened.goto((small_study / "results/report.html").as_uri())
    return opened


def test_every_figure_is_drawn(page):
    drawn = page.eval_on_selector_all(
        "figure img", "found => found.map(i => [i.alt, i.naturalWidth, i.complete])"
    )
    assert [name for name, *_ in drawn] and {name for name, *_ in drawn} == {
        *(f"Figure {n}" for n in range(1, 16)),
        *(
            f"{name}, bench" for name in ("Residuals", "Gap", "Map", "Half swings", "Ranking")
        ),  # of the search
    }
    assert all(complete and width > 300 for _, width, complete in drawn), drawn


def test_every_figure_and_table_has_a_caption(page):
    captions = page.eval_on_selector_all("figcaption, caption", "found => found.map(c => c.innerText)")
    assert len(captions) > 15
    assert all(len(text) > 30 for text in captions), captions


def test_the_contents_lead_to_what_they_name(page):
    links = page.eval_on_selector_all(
        "nav a",
        "found => found.map(a => [a.innerText, document.querySelector(a.getAttribute('href')) !== null])",
    )
    assert len(links) > 20
    assert all(there for _, there in links), links


def test_it_opens_with_findings_and_says_what_is_emulated_and_inferred(page):
    text = page.inner_text("main")
    assert page.inner_text("h2 >> nth=0") == "Findings"
    assert page.locator(".findings li").count() >= 2
    assert "emulated" in page.inner_text(".notice")
    assert "inferred" in text
    for fact in ("seed", "numpy", "SHA-256", "realizations: 2"):
        assert fact in text


def test_nothing_runs_wider_than_the_page(page):
    assert page.evaluate("document.documentElement.scrollWidth <= document.documentElement.clientWidth")


def test_nothing_is_fetched_from_outside(page):
    assert [url for url in page.asked if not url.startswith(("file:", "data:"))] == []


def test_every_table_and_figure_of_results_leads_to_its_file_and_rule(page, small_study):
    """But for what the run itself is: versions and inputs."""
    captions = page.eval_on_selector_all(
        "figcaption, caption",
        "found => found.map(c => [c.querySelector('b').innerText, c.querySelector('.source a')?.getAttribute('href'), c.innerText])",
    )
    for label, link, text in captions:
        if label not in ("Versions.", "Inputs."):
            assert link and "rule " in text, label
            assert (small_study / "results" / link).exists(), link
