"""The package's own files in YAML, which lie beside its modules."""

from pathlib import Path
from typing import Any

import yaml

# libyaml, some ten times as quick, where PyYAML was built with it
_QUICK = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def read_own(path: Path) -> Any:
    """What a file of the package holds; what users write is read by ``schema.read_yaml``, that tells them what is wrong."""
    return yaml.load(path.read_text(encoding="utf-8"), Loader=_QUICK)
