"""What a sample sheet states beside its files: lengths, and what was varied between recordings."""

from collections.abc import Mapping

CELLS = ("length", "bob_diameter", "bob_density", "pivot_distance", "mass", "area", "current", "group")
_SERIES = ("length", "mass", "area", "current")
_FEWEST = 3  # values that a law is fitted to


def varied_in(stated: Mapping[str, Mapping[str, str]]) -> tuple[str, ...]:
    """The figures that these cells by recording ask for: ``series``, where a column has three values, and ``groups``, where there are two."""

    def different(column: str) -> int:
        return len({cells[column] for cells in stated.values() if column in cells})

    series = ("series",) if any(different(one) >= _FEWEST for one in _SERIES) else ()
    return (*series, "groups") if different("group") > 1 else series
