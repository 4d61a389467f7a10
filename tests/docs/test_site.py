"""The site: made from the code, and built so that a link which leads nowhere ends it."""

import re
import subprocess

import pytest

from swingdown.pendulum.catalogue import SHIPPED


@pytest.fixture(scope="module")
def site(root):
    """The site, as ``make docs`` builds it."""
    done = subprocess.run(["make", "docs"], cwd=root, text=True, capture_output=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return root / "site"


@pytest.mark.slow("the site is built")
def test_every_effect_stands_in_the_catalogue_with_equation_sketch_and_source(site):
    text = (site / "docs/generated/catalogue.html").read_text(encoding="utf-8")
    for effect in SHIPPED:
        entry = text.split(f">{effect.name}<a")[1].split("<h3")[0]
        assert "<math" in entry and "Source: " in entry
        assert effect.name in ("viscous", "load_coulomb") or f"{effect.name}.svg" in entry
        assert all(f">{parameter.name}<" in entry for parameter in effect.parameters)


@pytest.mark.slow("the site is built")
def test_calls_settings_and_commands_are_there(site):
    page = site / "docs/generated"
    assert 'id="swingdown.explain"' in (page / "api_swingdown.html").read_text(encoding="utf-8")
    settings = (page / "settings.html").read_text(encoding="utf-8")
    for key in (
        "discovery.budget_s",
        "effects.NAME.torque",
        "sweeps.NAME.axes",
        "clock_tolerance",
        "encoder.limits",
    ):
        assert f">{key}<" in settings
    assert "--together" in (page / "commands.html").read_text(encoding="utf-8")


@pytest.mark.slow("the site is built")
def test_nothing_is_fetched_from_outside(site):
    for page in site.rglob("*.html"):
        fetched = re.findall(
            r"<(?:script|link|img)[^>]*(?:src|href)=\"(https?://[^\"]*)", page.read_text(encoding="utf-8")
        )
        assert not fetched, (page, fetched)


@pytest.mark.slow("the site is built")
@pytest.mark.parametrize(
    ("link", "ends"), [("alone.md#a-page", False), ("nowhere.md", True), ("alone.md#nothing", True)]
)
def test_a_link_that_leads_nowhere_ends_it(root, site, tmp_path, link, ends):
    """A page by itself, with the site's own settings."""
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs/alone.md").write_text(f"# A page\n\n[there]({link})\n", encoding="utf-8")
    (python,) = (root / ".venv").glob("docs-*/bin/python")
    chosen = ["-D", "root_doc=docs/alone", "-D", "include_patterns=docs/alone.md"]
    command = [
        python,
        "-m",
        "sphinx",
        "-q",
        "-W",
        "-b",
        "dummy",
        "-c",
        root / "docs",
        *chosen,
        tmp_path,
        tmp_path / "site",
    ]
    done = subprocess.run(command, text=True, capture_output=True)
    assert (done.returncode != 0) is ends, done.stderr
    assert (link in done.stderr or link.split("#")[-1] in done.stderr) is ends
