"""A class, a series: periods, qualities and decays against lengths, masses, areas and currents, and group against group.

Plain functions on arrays and tables: ``power_law``, ``gravity_of_lengths`` and ``compare`` on arrays; ``series_of`` on a table of
``studies.pendulums`` (``first_answer.csv``, ``pendulums.csv``), or of what was timed by hand (``timed``).
"""

from ..studies.power_laws import LengthsAndPeriods, PowerLaw, gravity_of_lengths, power_law
from .groups import Comparison, compare
from .table import Series, as_laws, as_table, of_sheet, series_of
from .timed_periods import Timed, timed
from .values import from_names, from_rows, from_table, merged

__all__ = [
    "Comparison", "LengthsAndPeriods", "PowerLaw", "Series", "Timed", "as_laws", "as_table", "compare", "from_names", "from_rows", "from_table",
    "gravity_of_lengths", "merged", "of_sheet", "power_law", "series_of", "timed",
]  # fmt: skip
