"""Names for the kinds of numbers that functions take and give."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.floating[Any]]
Numbers = float | Floats  # one, or one a point or draw
Swing = tuple[Floats, Floats]  # times (s) and angles (rad), one as long as the other
