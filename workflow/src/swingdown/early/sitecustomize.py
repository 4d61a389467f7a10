"""Read by Python itself before any script that a run starts: the workflow's own are handed over here (``swingdown.prefork``).

That is before the lines that Snakemake puts at their head, whose imports take longer than many a job.
"""

import os
import sys


def _read_own() -> None:
    """The file of this name that Python would have read without this one, if there is any."""
    import importlib.util

    sys.path[:] = [folder for folder in sys.path if folder != os.path.dirname(__file__)]
    this = sys.modules.pop("sitecustomize")
    if importlib.util.find_spec("sitecustomize"):
        importlib.import_module("sitecustomize")
    else:
        sys.modules["sitecustomize"] = this  # Python looks for what it has just read


if sys.argv and os.path.join(".snakemake", "scripts", "") in sys.argv[0]:
    from swingdown import prefork

    prefork.hand_over()
_read_own()
