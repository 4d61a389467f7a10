"""A config file that cannot be used is told by plain ``snakemake`` as our own checks tell it."""

import subprocess
import sys

import pytest

# Ten lines that stand for ten to the ninth.
BOMB = b"a0: &a0 [x]\n" + b"".join(
    b"a%d: &a%d [%s]\n" % (k, k, b", ".join([b"*a%d" % (k - 1)] * 10)) for k in range(1, 10)
)


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (b"recordings: sheet.csv\nsimulation: {simulated: []\nseed: 3\n", "mine.yaml, line 3"),
        (b"recordings: sh\xe4.csv\n", "it is not text in UTF-8"),
        (b"seed: 3\nrecordings: sheet.csv\nseed: 4\n", "mine.yaml, line 3"),
        (b"simulation: &a {snr: *a}\n", "mine.yaml, line 1"),
        (b"seed: " + b"[" * 20000 + b"]" * 20000, "mine.yaml, line 1"),
        (BOMB, "mine.yaml"),
        (None, "there is no such config file"),
    ],
)
@pytest.mark.parametrize("option", ["--configfile", "--configfiles"])
def test_what_is_wrong_with_a_config_is_told_once(tmp_path, root, content, told, option):
    path = tmp_path / "mine.yaml"
    if content is not None:
        path.write_bytes(content)
    command = [
        sys.executable,
        "-m",
        "snakemake",
        "-c1",
        "all",
        "--directory",
        str(tmp_path),
        option,
        str(path),
    ]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, timeout=120)
    said = done.stdout + done.stderr
    assert done.returncode == 1
    assert said.count("This input cannot be used") == 1 and told in said and "mend:" in said
    assert "Traceback" not in said and "Error" not in said
