"""A machine that has no C compiler, and nothing compiled before."""

import os
import subprocess
import sys

import pytest

USES = {
    "simulate": "swingdown.simulate('viscous', np.arange(0, 2, 0.1), 0.3, natural_frequency=7.0, viscous_ratio=0.01)",
    "fit": "swingdown.fit(np.arange(0, 9, 0.05), 0.3 * np.cos(7 * np.arange(0, 9, 0.05)), unit='rad')",
}


@pytest.mark.parametrize("use", USES)
def test_nothing_is_computed_and_the_mend_is_told(use, tmp_path):
    clean = {key: value for key, value in os.environ.items() if key != "CC"}
    clean |= {"PATH": "", "SWINGDOWN_CACHE": str(tmp_path)}
    code = f"import numpy as np, swingdown\n{USES[use]}"
    done = subprocess.run([sys.executable, "-c", code], env=clean, text=True, capture_output=True)
    assert done.returncode == 1
    assert "there is no C compiler" in done.stderr and "Mend: install gcc or clang" in done.stderr
