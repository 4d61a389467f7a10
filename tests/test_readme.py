"""What README shows of the package runs as it stands there."""

import re

import numpy as np


def test_the_notebooks_lines_run_and_find_the_truth(root):
    (code,) = re.findall(
        r"^```python\n(.*?)^```$", (root / "README.md").read_text(), re.DOTALL | re.MULTILINE
    )
    names = {}
    exec(compile(code, "README.md", "exec"), names)
    fit, truth = names["fit"], names["truth"]
    errors = fit.standard_errors[: len(truth.parameters)]
    assert np.all(np.abs(fit.values[: errors.size] - truth.vector()) < 4 * errors)
