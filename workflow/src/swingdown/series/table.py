"""A class, a series: the quantities of a table of pendulums against what was varied between them, and group against group."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from ..arrays import Floats
from ..errors import InputError
from ..measurement.stated import Stated
from ..measurement.straight_line import FEWEST
from ..rounding import value_with_uncertainty
from ..studies.power_laws import LengthsAndPeriods, PowerLaw, ShiftedLaw, gravity_of_lengths, power_law
from .groups import Comparison, compare
from .values import from_rows


class Kind(NamedTuple):
    """A quantity of a pendulum that goes into a series: its symbol, its words, its unit."""

    symbol: str
    words: str
    unit: str


_AGREES = 2.0  # standard uncertainties: an exponent that is no farther agrees with theory's
PERIOD, QUALITY, DECAY = "period", "quality", "decay_rate"
KINDS = {
    PERIOD: Kind("T", "period of small swings", "s"),
    QUALITY: Kind("Q", "quality", "1"),
    DECAY: Kind("γ", "decay rate, 1 over the decay time", "1/s"),
}
SHOWN = {"length": (PERIOD, QUALITY), "mass": (QUALITY, DECAY, PERIOD), "area": (DECAY,), "current": (DECAY,)}
# Exponents: a bob on a string, drag that the mass knows nothing of, drag by the area, eddy currents by the square of the field.
THEORY = {
    ("length", PERIOD): 0.5,
    ("mass", PERIOD): 0.0,
    ("mass", QUALITY): 1.0,
    ("mass", DECAY): -1.0,
    ("area", DECAY): 1.0,
    ("current", DECAY): 2.0,
}


@dataclass(frozen=True)
class Series:
    """One quantity against what was varied, or between groups.

    Attributes
    ----------
    by, unit
        What was varied, and its unit.
    quantity
        The quantity, one of ``KINDS``.
    table
        A row for each recording: recording, label, x and u_x (0: not stated) or group, y, u_y; of a law also residual and by_theory,
        of groups that are compared ``at_equal`` also y_at_equal.
    law, gravity, comparison
        The power law, g, and the comparison of groups; None where they do not apply.
    at_equal, mixed
        Other columns that vary: those at whose equal values groups are compared, and those of which no values are equal in all groups.
    """

    by: str
    unit: str
    quantity: str
    table: pd.DataFrame = field(repr=False)
    law: PowerLaw | None = None
    gravity: LengthsAndPeriods | None = None
    comparison: Comparison | None = None
    at_equal: tuple[str, ...] = ()
    mixed: tuple[str, ...] = ()

    @property
    def sentence(self) -> str:
        """A sentence: the power law with theory's and g, or which groups agree."""
        kind = KINDS[self.quantity]
        if self.comparison:
            held = "".join(f", at equal {one}" for one in self.at_equal)
            all_told = [self.comparison.sentence, *(f"the recordings differ in {one}" for one in self.mixed)]
            return f"{kind.words} by {self.by}{held}: {'; '.join(all_told)}"
        assert self.law and self.told
        law, told = self.law, self.told
        less = ""
        if np.isfinite(law.u_offset):
            less = f" less {value_with_uncertainty(law.offset, law.u_offset)} {kind.unit}"
        beside = "" if told is law else ", beside an error that all lengths share"
        power = value_with_uncertainty(told.exponent, told.u_exponent)
        parts = [f"{kind.symbol}{less} goes as the power {power} of {self.by}{beside}"]
        if np.isfinite(law.theory):
            verdict = "which agrees" if self.away <= _AGREES else "which does not agree"
            away = f"{self.away:.1f} standard uncertainties away"
            parts.append(f"theory says {law.theory:g}, {verdict} ({away})")
        if told is not law:
            parts.append(f"without one the power is {value_with_uncertainty(law.exponent, law.u_exponent)}")
        parts += [law.scatter.sentence, self.gravity.sentence if self.gravity else ""]
        parts += [] if (self.table["u_x"] > 0).any() else [f"the uncertainty of {self.by} was not given"]
        return "; ".join(filter(None, parts))

    @property
    def told(self) -> PowerLaw | ShiftedLaw | None:
        """The law whose exponent is told: of periods over four lengths or more that beside an error which all lengths share.

        All are measured from one pivot to one place of the bob, and how far that is off no scatter shows.
        """
        shifted = self.gravity.shifted if self.gravity else None
        return shifted if shifted and np.isfinite(shifted.u_exponent) else self.law

    def by_theory(self, x: Floats) -> Floats:
        """What theory says, through the same points, with the same error that all lengths share.

        Parameters
        ----------
        x
            What was varied, in ``unit``.
        """
        assert self.law
        shared = self.gravity if self.told is not self.law else None
        return (shared or self.law).by_theory(x)

    @property
    def away(self) -> float:
        """The distance of the exponent that is told from theory's, in standard uncertainties; NaN without a theory."""
        if not (self.law and self.told):
            return float("nan")
        return abs(self.told.exponent - self.law.theory) / self.told.u_exponent

    @property
    def shared_error(self) -> bool:
        """Whether theory's exponent agrees where all lengths may be off by one amount, and else does not."""
        if not (self.law and self.gravity and self.law.away > _AGREES and self.gravity.off):
            return False
        return self.told is not self.law and self.away <= _AGREES

    def to_dict(self) -> dict[str, Any]:
        """A dict of plain numbers and texts."""
        return {
            "by": self.by, "unit": self.unit, "quantity": self.quantity, "sentence": self.sentence,
            **_exponents(self),
            "power_law": self.law.to_dict() if self.law else None,
            "gravity": self.gravity.to_dict() if self.gravity else None,
            "comparison": self.comparison.to_dict() if self.comparison else None,
            "theory_with_shared_error_of_lengths": self.shared_error,
            "at_equal": list(self.at_equal),
        }  # fmt: skip


def _quantities_in(table: pd.DataFrame) -> pd.DataFrame:
    """A row for each recording of a table of ``studies.pendulums``: each of ``KINDS`` and its uncertainty, NaN where it has none. The period is
    that of small undamped swings; of passages that as recorded.
    """
    one = table[table["recording"] != "(joint)"]
    found = pd.DataFrame({"recording": one["recording"], "label": one["label"]})

    def column(name: str) -> pd.Series:
        return pd.to_numeric(one[name], errors="coerce") if name in one else pd.Series(np.nan, one.index)

    omega, u_omega = column("natural_frequency_rad_per_s"), column("natural_frequency_rad_per_s_u")
    small = 2 * np.pi / omega
    found[PERIOD] = small.fillna(column("period_s"))
    found[f"{PERIOD}_u"] = (small * u_omega / omega).fillna(column("period_s_u"))
    found[QUALITY], found[f"{QUALITY}_u"] = column("quality"), column("quality_u")
    found[DECAY] = 1 / column("decay_time_s")
    found[f"{DECAY}_u"] = column("decay_time_s_u") * found[DECAY] ** 2
    return found.reset_index(drop=True)


def series_of(
    table: pd.DataFrame,
    values: Mapping[str, Mapping[str, Stated]],
    groups: Mapping[str, Mapping[str, str]] | None = None,
    by: str = "",
) -> list[Series]:
    """The list of ``Series`` in a table: against what was varied, and between groups.

    A recording without a quantity or its uncertainty is left out.

    Parameters
    ----------
    table
        A table of ``studies.pendulums``.
    values
        By recording, then by column, in SI units.
    groups
        By recording, then by column.
    by
        The column to use. Default: every column with three values in three recordings, and all groups.

    Raises
    ------
    InputError
        If ``by`` is no such column.
    """
    measured, groups = _quantities_in(table), groups or {}
    columns = list(dict.fromkeys(column for own in values.values() for column in own))
    words = list(dict.fromkeys(column for own in groups.values() for column in own))
    found: list[Series] = []
    for column in [one for one in columns if by in ("", one)]:
        stated = {key: own[column] for key, own in values.items() if column in own}
        found += _against(measured, stated, column)
    for column in [one for one in words if by in ("", one)]:
        member = {key: own[column] for key, own in groups.items() if column in own}
        found += _between(measured, member, column, values)
    if by and not found:
        known = ", ".join((*columns, *words)) or "none"
        raise InputError(
            f"--by {by}", f"it has fewer than {FEWEST} values, and no two groups; the recordings have {known}",
            "a column of the sheet, of a table beside the files, or a value in their names", "name one of these, or add the column",
        )  # fmt: skip
    return found


def _against(measured: pd.DataFrame, values: Mapping[str, Stated], column: str) -> list[Series]:
    units = {one.unit for one in values.values()}
    if len(units) > 1:
        raise InputError(f"column {column}", f"its units are {', '.join(sorted(units))}", "one unit", "convert them")  # fmt: skip
    chosen = measured[measured["recording"].isin(values)].reset_index(drop=True)
    chosen["x"] = [values[name].value for name in chosen["recording"]]
    chosen["u_x"] = np.nan_to_num([values[name].uncertainty for name in chosen["recording"]])
    found = []
    for quantity in SHOWN.get(column, tuple(KINDS)):
        own = _with(chosen, quantity)
        if own.loc[own["x"] > 0, "x"].nunique() < FEWEST or (own["x"] < 0).any():
            continue
        points = own["x"], own["y"], own["u_x"], own["u_y"]
        law = power_law(*points, THEORY.get((column, quantity), np.nan))
        gravity = gravity_of_lengths(*points) if (column, quantity) == ("length", PERIOD) else None
        made = Series(column, units.copy().pop(), quantity, own, law, gravity)
        own["residual"] = own["y"] - made.told(own["x"]) if made.told else np.nan
        own["by_theory"] = made.by_theory(own["x"]) if np.isfinite(law.theory) else np.nan
        found.append(made)
    return found


def _between(
    measured: pd.DataFrame, groups: Mapping[str, str], column: str, values: Mapping[str, Mapping[str, Stated]]
) -> list[Series]:
    if len(set(groups.values())) < 2:
        return []
    chosen = measured[measured["recording"].isin(groups)].reset_index(drop=True)
    chosen["group"] = [groups[name] for name in chosen["recording"]]
    found = []
    for quantity in KINDS:
        own = _with(chosen, quantity)
        if own["group"].nunique() > 1:
            own, at, mixed = _at_equal(own, values)
            y, u, taken = own["y"], own["u_y"], 0
            if at:
                y, taken = own["y_at_equal"], own["at"].nunique() - 1
                u = own["u_y"] * y / own["y"]
            comparison = compare(list(own["group"]), y, u, taken)
            own = own.drop(columns="at", errors="ignore")
            found.append(Series(column, "", quantity, own, comparison=comparison, at_equal=at, mixed=mixed))
    return found


def _at_equal(
    own: pd.DataFrame, values: Mapping[str, Mapping[str, Stated]]
) -> tuple[pd.DataFrame, tuple[str, ...], tuple[str, ...]]:
    """The recordings at those values of other columns that every group has, the columns, and those that vary and have none such.

    ``at`` numbers the values; ``y_at_equal`` is y with their part taken off: over the mean of the groups there, times that of all.
    """
    known = [values.get(name, {}) for name in own["recording"]]
    columns = dict.fromkeys(column for each in known for column in each)
    varied = [one for one in columns if len({each[one].value for each in known if one in each}) > 1]
    at: list[str] = []
    kept = own
    for column in varied:
        together = [*at, column]
        places = [tuple(each[one].value if one in each else None for one in together) for each in known]
        numbers: dict[Any, int] = {place: k for k, place in enumerate(dict.fromkeys(places))}
        found = own.assign(at=[numbers[place] for place in places])
        full = found.groupby("at")["group"].transform("nunique") == own["group"].nunique()
        full &= np.array([None not in place for place in places])
        if full.any():
            at, kept = [*at, column], found[full].reset_index(drop=True)
    if at:
        each = kept.groupby(["at", "group"])["y"].mean().groupby("at").mean()
        kept["y_at_equal"] = kept["y"] / kept["at"].map(each) * each.mean()
    return kept, tuple(at), tuple(one for one in varied if one not in at)


def _with(chosen: pd.DataFrame, quantity: str) -> pd.DataFrame:
    """The recordings that have a quantity with its uncertainty, as y and u_y."""
    own = chosen.rename(columns={quantity: "y", f"{quantity}_u": "u_y"})
    own = own[np.isfinite(own["y"]) & (own["y"] > 0) & np.isfinite(own["u_y"]) & (own["u_y"] > 0)]
    names = [name for name in ("recording", "label", "x", "u_x", "group", "y", "u_y") if name in own]
    return own[names].reset_index(drop=True)


def as_table(found: Sequence[Series]) -> pd.DataFrame:
    """All points of all series below each other.

    Parameters
    ----------
    found
        As ``series_of`` returns them.

    Returns
    -------
    pandas.DataFrame
        ``by`` (what was varied) with its unit, ``quantity`` with its unit, then the columns of each series.
    """
    if not found:
        names = ["recording", "label", "by", "by_unit", "quantity", "unit", "x", "u_x", "y", "u_y"]
        return pd.DataFrame(columns=names)
    parts = []
    for one in found:
        part = one.table.copy()
        texts = one.by, one.unit, one.quantity, KINDS[one.quantity].unit
        for place, pair in enumerate(zip(("by", "by_unit", "quantity", "unit"), texts, strict=True), 2):
            part.insert(place, *pair)
        parts.append(part)
    return pd.concat(parts, ignore_index=True)


_EXPONENTS = ("exponent", "u_exponent", "exponent_of_exact_lengths", "u_exponent_of_exact_lengths")
_LAWS = ("theory", "chi2", "dof", "p", "birge_ratio", "widened_by")


def _exponents(one: Series) -> dict[str, float | None]:
    """The exponent that is told with its uncertainty, and where it allows for an error that all lengths share, that of exact lengths."""
    known = [one.told, one.law if one.told is not one.law else None]
    cells = [value for law in known for value in ((law.exponent, law.u_exponent) if law else (None, None))]
    return dict(zip(_EXPONENTS, cells, strict=True))


def as_laws(found: Sequence[Series]) -> pd.DataFrame:
    """A row for each series.

    Parameters
    ----------
    found
        As ``series_of`` returns them.

    Returns
    -------
    pandas.DataFrame
        ``by``, ``quantity``, the exponent or the chi2 of equality, g from the slope, and the sentence.
    """
    rows = []
    for one in found:
        row: dict[str, Any] = {"by": one.by, "quantity": one.quantity}
        row |= _exponents(one)
        row |= {name: one.law.to_dict()[name] for name in _LAWS} if one.law else {}
        row |= one.gravity.to_dict() if one.gravity else {}
        if one.comparison:
            row |= {name: getattr(one.comparison, name) for name in ("chi2", "dof", "p")}
        rows.append(row | {"sentence": one.sentence})
    ends = ["g_m_per_s2", "u_g_m_per_s2", "lengths_too_short_by_m", "u_lengths_too_short_by_m", "sentence"]
    return pd.DataFrame(rows, columns=["by", "quantity", *_EXPONENTS, *_LAWS, *ends])


def of_sheet(table: pd.DataFrame, stated: Mapping[str, Mapping[str, Any]]) -> list[Series]:
    """The ``Series`` of a study's table by the cells of its sample sheet; none where they make none.

    Parameters
    ----------
    table
        As ``studies.pendulums.pendulums`` returns it.
    stated
        By recording, the cells of its row of the sheet.

    Raises
    ------
    InputError
        If a cell is no quantity of its column.
    """
    values, groups = from_rows({"recording": name} | dict(cells) for name, cells in stated.items())
    try:
        return series_of(table, values, groups)
    except InputError:
        return []
