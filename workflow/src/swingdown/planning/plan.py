"""What a study consists of: which recordings are fitted, in which campaigns, and which need the calibration."""

import difflib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ..errors import InputError
from ..measurement.apparatus import read_apparatus
from ..measurement.sheet import read_sheet
from ..paths import safe_name


@dataclass(frozen=True)
class Plan:
    """The recordings of a study, by name, in the order of the sample sheet."""

    rows: dict  # recording: {column: value} of the sample sheet
    campaigns: tuple = ()  # those that are fitted
    searched: tuple = ()  # those in which missing effects are looked for
    apparatus: str | None = None  # path of the apparatus sheet, where a recording needs it

    def swings(self, campaign: str | None = None) -> list[str]:
        """The names of the recordings that are fitted: all but the static ones, of one campaign or of all chosen."""
        return self._named(self.campaigns if campaign is None else (campaign,), (False,))

    def statics(self, campaign: str | None = None) -> list[str]:
        """The names of the recordings of the pendulum at rest."""
        return self._named(self.campaigns if campaign is None else (campaign,), (True,))

    def changed(self, campaign: str) -> tuple[str, dict[str, float | str]] | None:
        """What was changed between the swings of a campaign, and its value in each, by name; None where nothing was.

        InputError where some do not say it, or say another thing.
        """
        rows = {name: self.rows[name] for name in self.swings(campaign)}
        stated = {name: (row["changed"], row["changed_value"]) for name, row in rows.items()}
        said = {name: one for name, one in stated.items() if any(one)}
        if not said:
            return None
        quantity = next(iter(said.values()))[0]
        for name, (what, value) in stated.items():
            if what != quantity or not value:
                raise InputError(
                    f"recording {name}", f"it has {what!r} as changed and {value!r} as changed_value, and {next(iter(said))} has {quantity!r}",
                    "one thing that was changed in a campaign, and its value in each recording",
                    "fill in both cells, with 0 where there was none of it, or make two campaigns of it",
                )  # fmt: skip
        try:
            return quantity, {name: float(value) for name, (_, value) in stated.items()}
        except ValueError:
            return quantity, {name: value for name, (_, value) in stated.items()}

    @property
    def in_volts(self) -> list[str]:
        """The names of the recordings whose angle follows from the calibration."""
        return [name for name in self.measured if self.apparatus and self.rows[name]["signal_unit"] == "V"]

    @property
    def moving(self) -> list[str]:
        """The names of the recordings of swings, of all campaigns that are fitted or searched."""
        return self._named((*self.campaigns, *self.searched), (False,))

    @property
    def still(self) -> list[str]:
        """The names of the recordings of the pendulum at rest, of all campaigns that are fitted or searched."""
        return self._named((*self.campaigns, *self.searched), (True,))

    @property
    def measured(self) -> list[str]:
        """The names of all recordings of the campaigns that are fitted or searched, static ones included."""
        return self._named((*self.campaigns, *self.searched), (True, False))

    def _named(self, campaigns: Sequence[str], static: Sequence[bool]) -> list[str]:
        own = [name for name, row in self.rows.items() if row["campaign"] in campaigns]
        return [name for name in own if (self.rows[name]["role"] == "static") in static]


def plan(settings: dict[str, Any]) -> Plan:
    """The Plan that complete settings (``settings.complete``) and the sheets they name lay down.

    InputError for a campaign that is not in the sheet or has nothing to fit, and for recordings in volts whose campaign the apparatus sheet
    does not cover.
    """
    if "recordings" not in settings:
        return Plan({})
    sheet = read_sheet(settings["recordings"])
    # The line of a row is left out: inserting a row above must not run the others again.
    rows = {
        str(name): {"recording": str(name)} | row.drop("line").to_dict() for name, row in sheet.iterrows()
    }
    known = list(dict.fromkeys(row["campaign"] for row in rows.values()))
    campaigns = _chosen(settings, "experiment", known) or tuple(known)
    searched = _chosen(settings, "discovery", known) or campaigns
    result = Plan(rows, campaigns, searched, settings.get("apparatus"))
    for name in dict.fromkeys((*campaigns, *searched)):
        if not result.swings(name):
            where = f"{settings['recordings']}, campaign {name}"
            raise InputError(where, "every recording is static", "at least one swing to fit", "add a swing")
    for name in searched:
        result.changed(name)
    if result.in_volts:
        _check_apparatus(result)
    return result


def _chosen(settings: dict[str, Any], part: str, known: Sequence[str]) -> tuple[str, ...]:
    chosen = tuple(safe_name(name) for name in settings[part]["campaigns"])
    for name in chosen:
        if name not in known:
            near = difflib.get_close_matches(name, known, 1, 0.5)
            mend = f"write {near[0]!r}" if near else "name a campaign of the sheet, or none for all"
            problem = f"no recording of {settings['recordings']} belongs to the campaign {name!r}"
            raise InputError(f"config, key {part}.campaigns", problem, ", ".join(known), mend)
    return chosen


def _check_apparatus(plan: Plan) -> None:
    covered = read_apparatus(str(plan.apparatus))["campaigns"]
    for name in plan.in_volts:
        if (campaign := plan.rows[name]["campaign"]) not in covered:
            where = f"{plan.apparatus}, key campaigns"
            problem = f"the campaign {campaign!r} of recording {name!r} (in volts) is not listed"
            raise InputError(where, problem, "every campaign that is recorded in volts", f"add {campaign!r}")
