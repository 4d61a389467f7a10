"""Noise models by their statistics, R's stream by numbers that real R printed."""

import shutil
import subprocess

import numpy as np
import pytest

from swingdown.errors import InputError
from swingdown.studies import noise

# sprintf("%.17g", …) in R 4.2.2 (Debian r-base-core); positions count from 1 as in R
NORMALS_OF_150 = {
    1: -1.6323097021885307,
    2: -0.062996263483676707,
    3: -0.70544686160440206,
    4: -0.31417818163553074,
    5: -0.2669462692930385,
    501: 0.83211231976965683,
    502: 0.18476856608563835,
    1000: 0.43307745155864696,
    15030: -1.1825440957724649,
}
UNIFORMS_OF_150 = [0.051307131536304951, 0.44502916955389082, 0.47488473611883819]
NORMALS_OF_OTHER_SEEDS = {
    0: [1.2629542848807933, -0.3262333607056494],
    1: [-0.62645381074233242, 0.18364332422208224],
    -7: [-0.44961272857821438, -0.65965939010483454],
    20240131: [0.9084434369377179, -0.32373507095596604],
}


def test_r_stream_of_the_papers_seed_is_what_r_prints():
    drawn = noise.RStream(150).standard_normal(15030)
    for position, printed in NORMALS_OF_150.items():
        assert drawn[position - 1] == pytest.approx(printed, abs=1e-14)
    assert noise.RStream(150).uniform(3) == pytest.approx(UNIFORMS_OF_150, abs=1e-16)


@pytest.mark.parametrize("seed", NORMALS_OF_OTHER_SEEDS)
def test_r_stream_of_other_seeds(seed):
    assert noise.RStream(seed).standard_normal(2) == pytest.approx(NORMALS_OF_OTHER_SEEDS[seed], abs=1e-14)


def test_r_stream_goes_on_where_it_stopped():
    whole = noise.RStream(150).standard_normal(3000)
    parts = noise.RStream(150)
    assert np.array_equal(whole, np.concatenate([parts.standard_normal(size) for size in (1, 1000, 1999)]))
    mixed = noise.RStream(42)  # set.seed(42); c(runif(3), rnorm(2), runif(1))
    drawn = [*mixed.uniform(3), *mixed.standard_normal(2), *mixed.uniform(1)]
    printed = [
        0.91480604349635541,
        0.93707541329786181,
        0.28613953478634357,
        0.95593564863065084,
        0.047884736094251722,
        0.13466659723781049,
    ]
    assert drawn == pytest.approx(printed, abs=1e-14)


def test_r_stream_against_r_itself():
    if not shutil.which("Rscript"):
        pytest.skip("Rscript is not installed (Debian: r-base-core): only stored numbers checked")
    code = 'for (s in c(150, 7)) {set.seed(s); cat(sprintf("%.17g ", c(rnorm(1000), runif(1000))))}'
    command = ["Rscript", "--vanilla", "-e", code]
    printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    ours = []
    for stream in (noise.RStream(150), noise.RStream(7)):
        ours += [*stream.standard_normal(1000), *stream.uniform(1000)]
    assert np.max(np.abs(np.array(printed.split(), float) - ours)) < 2e-15


@pytest.mark.parametrize("seed", [1.5, 2**31, "150"])
def test_a_seed_that_r_would_not_take_is_refused(seed):
    with pytest.raises(InputError, match="seed"):
        noise.RStream(seed)


def test_numpy_streams_depend_on_seed_label_and_index_only():
    first = noise.numpy_stream(150, "viscous", 3).standard_normal(5)
    assert np.array_equal(first, noise.numpy_stream(150, "viscous", 3).standard_normal(5))
    for other in ((151, "viscous", 3), (150, "quadratic_drag", 3), (150, "viscous", 4)):
        assert not np.array_equal(first, noise.numpy_stream(*other).standard_normal(5))


SERIES = 0.35 * np.cos(np.linspace(0, 40, 20001))


def test_proportional_noise_is_two_percent_everywhere_and_nothing_at_a_crossing():
    noisy = noise.add_noise("proportional", SERIES, 50, noise.RStream(150).standard_normal(SERIES.size))
    assert np.std((noisy - SERIES) / np.abs(SERIES)) == pytest.approx(0.02, rel=0.02)
    at_crossing_and_beyond = noise.add_noise("proportional", [0.0, 1.0, -1.0], 50, np.array([3.0, 3.0, 3.0]))
    assert at_crossing_and_beyond == pytest.approx([0.0, 1.06, -0.94])


def test_additive_and_quantisation_noise_have_the_size_that_snr_says():
    size = np.sqrt(np.mean(SERIES**2)) / 50
    draws = noise.RStream(150).standard_normal(SERIES.size)
    assert np.std(noise.add_noise("additive", SERIES, 50, draws) - SERIES) == pytest.approx(size, rel=0.02)
    rounded = noise.add_noise("quantisation", SERIES, 50, draws)
    assert np.std(rounded - SERIES) == pytest.approx(size, rel=0.05)
    assert np.max(np.abs(rounded - SERIES)) <= np.sqrt(3) * size * (1 + 1e-9)
    step = np.sqrt(12) * size
    assert rounded == pytest.approx(step * np.round(rounded / step))


@pytest.mark.parametrize(("kind", "snr", "key"), [("pink", 50, "noise"), ("additive", 0, "snr")])
def test_unusable_settings_name_their_key(kind, snr, key):
    with pytest.raises(InputError, match=f"simulation.{key}"):
        noise.add_noise(kind, SERIES, snr, SERIES)
