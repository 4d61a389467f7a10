"""What README and the page on notebooks show of the package is so."""

import re


def test_the_notebooks_lines_run_and_find_the_truth(root):
    blocks = re.findall(
        r"^```python\n(.*?)^```$", (root / "docs/notebook.md").read_text(), re.DOTALL | re.MULTILINE
    )
    (code,) = [block for block in blocks if "load_friction" in block]
    names = {}
    exec(compile(code, "notebook.md", "exec"), names)
    found = names["swingdown"].fit(names["swing"], fitted=["viscous+load_coulomb"])
    truth = {"natural_frequency": 7.25, "viscous_ratio": 0.01, "load_friction": 0.003}
    assert all(abs(found[name].value - value) < 4 * found[name].u for name, value in truth.items())


def test_readme_shows_what_the_tutorial_is_held_to(root):
    """README's example is the one of docs/own-file.md, which is run."""
    readme, tutorial = ((root / name).read_text() for name in ("README.md", "docs/own-file.md"))
    shown = re.search(r"^```\n(anna\.csv: .*?)^```$", readme, re.DOTALL | re.MULTILINE)[1].splitlines()
    told = "".join(re.findall(r"^<!-- prints -->\n```\n(.*?)^```$", tutorial, re.DOTALL | re.MULTILINE))
    assert any(line.startswith("anna: Named. ") for line in shown)
    # of the file that the project ships it is told that it was computed
    assert set(shown) - {"…", "  emulated: computed, not measured on a real pendulum"} <= set(
        told.splitlines()
    )


def test_readme_stays_short(root):
    lines = (root / "README.md").read_text().splitlines()
    assert len(lines) <= 90
    assert all(len(line) <= 260 for line in lines)


def test_links_of_the_texts_lead_to_files(root):
    """Also in those texts that no site is built from."""
    texts = [
        root / "README.md",
        root / "CONTRIBUTING.md",
        root / "config/README.md",
        *(root / "docs").glob("*.md"),
    ]
    for text in texts:
        prose = re.sub(r"^```.*?^```$", "", text.read_text(), flags=re.DOTALL | re.MULTILINE)
        for link in re.findall(r"\]\(([^)#\s]+)[^)]*\)", prose):
            made = link.startswith("generated/")  # by `make docs`, which ends where it leads nowhere
            assert made or "://" in link or (text.parent / link).exists(), f"{text.name}: {link}"
