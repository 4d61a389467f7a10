"""An answer on one pendulum: it prints itself, draws itself, simulates, and goes to a table, a dataset or a dict."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import ArrayLike

from .. import markup
from ..arrays import Shown, finite_or_none
from ..curves.chosen import Fitted, of_verdict
from ..curves.dataset import curves as curves_of
from ..curves.laws import Laws, laws
from ..curves.laws import envelopes as envelopes_of
from ..curves.resonance import resonance
from ..discovery.tell.verdict import noise_rms
from ..errors import InputError
from ..extras import has, needed
from ..measurement.driven import CURVES, LAWS, check_free
from ..pendulum.catalogue import SHIPPED, Catalogue
from ..pendulum.model import Model
from ..studies.gravity import Gravity, with_gravity
from ..studies.pendulums import SEARCH, by_verdict, in_order, residual_of
from ..studies.quantities import Quantity
from ..studies.stop_watch import by_stop_watch
from ..studies.words import headline, lines, or_models, quantity_rows, short
from .recorded import samples_of
from .simulation import swing_of

if TYPE_CHECKING:
    from ..plots.style import Drawn


_WITH_ANGLES = "a swing, turning points, or passages with speeds"


class Begin(NamedTuple):
    """How a fitted swing begins: the time (s) of its first sample, angle (rad) and angular velocity (rad/s) there, and its length (s)."""

    time: float
    angle: float
    velocity: float
    duration: float


@dataclass(frozen=True)
class Answer:
    """The fits of one pendulum, its quantities with uncertainties, and, after ``explain``, the verdict.

    Attributes
    ----------
    swings
        Datasets of the angles (rad) over the time (s), without what a hand held.
    fits
        Every model of damping fitted to each swing (``studies.experiment``).
    table
        A row for each swing, and a last one for all together where there are several (``studies.pendulums``).
    shown
        The swings with the fit, as pictures show them.
    verdict
        The contents of ``verdict.json``; None after ``fit``.
    catalogue
        The effects that the models are made of.
    fitted_model
        As ``model``, or None.
    begins
        How each swing begins, by recording.
    fitted
        The model that describes the pendulum, with the covariance of its parameters.
    """

    swings: tuple[xr.Dataset, ...]
    fits: xr.Dataset = field(repr=False)
    table: pd.DataFrame = field(repr=False)
    shown: tuple[Shown, ...] = field(repr=False)
    verdict: Mapping[str, Any] | None = field(default=None, repr=False)
    catalogue: Catalogue = field(default=SHIPPED, repr=False)
    fitted_model: Model | None = field(default=None, repr=False)
    begins: Mapping[str, Begin] = field(default_factory=lambda: MappingProxyType({}), repr=False)
    fitted: Fitted | None = field(default=None, repr=False)

    @property
    def row(self) -> Mapping[str, Any]:
        """The table's row of the pendulum: of its only swing, or of all its swings together."""
        return self.table.iloc[-1].to_dict()

    @property
    def model(self) -> Model:
        """The ``Model`` that describes the pendulum, with fitted values and standard errors.

        Raises
        ------
        InputError
            If only passages without speeds are given.
        """
        if self.fitted_model is None:
            raise InputError("model", f"the damping is {self.label}", _WITH_ANGLES)
        return self.fitted_model

    @property
    def label(self) -> str:
        """The label of the model, names joined by ``+``, or why the damping is not known."""
        return str(self.row["model"])

    @property
    def sentence(self) -> str:
        """A sentence: what stops the pendulum, its period and its quality."""
        return headline(self.row, self.verdict, self.catalogue, self.restoring)

    @property
    def restoring(self) -> str:
        """The restoring torque: ``sine`` or ``linear``."""
        return str(self.fits.attrs.get("restoring", "sine"))

    @property
    def quantities(self) -> dict[str, Quantity]:
        """Each ``Quantity`` by name, with ``value``, ``u`` (standard uncertainty) and ``unit``.

        They are those of the first whole swing from the amplitude ``row["amplitude_rad"]``; ``to_dataframe`` says what is in its middle.
        """
        return {one.name: one.quantity for one in quantity_rows(self.row, self.verdict)}

    def __getitem__(self, name: str) -> Quantity:
        """The ``Quantity`` of a name: ``answer["period"]``.

        Raises
        ------
        InputError
            If there is none of that name; it lists the names.
        """
        found = self.quantities
        if name not in found:
            raise InputError(f"quantity {name!r}", "the answer has none of that name", ", ".join(found))
        return found[name]

    @property
    def remarks(self) -> list[str]:
        """What was noticed in the swings and their fits, a line each."""
        doubts = [str(row["remark"]) for row in self.table.to_dict("records") if row["remark"]]
        return [*self._as_given, *dict.fromkeys(doubts)]

    @property
    def _as_given(self) -> list[str]:
        noticed = [one.attrs for one in self.swings if one.attrs.get("remarks")]
        return [f"{one['recording']}: {one['remarks']}" for one in noticed]

    def with_verdict(self, found: Mapping[str, Any], shown: tuple[Shown, ...] = ()) -> "Answer":
        """The same answer with a verdict.

        Parameters
        ----------
        found
            The contents of ``verdict.json``.
        shown
            The swings with the fit of the search's last model.
        """
        table = self.table.copy().astype(object)
        row = by_verdict(self.table.iloc[-1].to_dict(), found)
        table = pd.concat([table.iloc[:-1], pd.DataFrame([row])], ignore_index=True)
        fitted = self.fitted
        if row.get("model_of") == SEARCH:
            fitted = of_verdict(found, self.restoring, self.catalogue) or fitted
        return replace(self, verdict=found, shown=shown or self.shown, table=in_order(table), fitted=fitted)

    def with_g(self, stated: Mapping[str, Mapping[str, Any]]) -> "tuple[Answer, dict[str, Gravity]]":
        """The same answer with g where a length is stated, and the ``Gravity`` of each of its recordings.

        Parameters
        ----------
        stated
            The cells of the sample sheet, by recording.
        """
        table, found = with_gravity(self.table, stated, self.restoring)
        return replace(self, table=table) if found else self, found

    def simulate(
        self,
        times: Any = None,
        angle: Any = None,
        *,
        velocity: float = 0.0,
        recording: str | None = None,
        noise: float = 0.0,
        seed: int = 0,
    ) -> xr.DataArray:
        """The swing of the answer's model, as a DataArray over ``time`` (s).

        Parameters
        ----------
        times
            Times in s, of shape (time,). Default: those of the recording.
        angle
            Angle (rad) from which the pendulum is let go at the first time. Default: the swing starts as the recording does.
        velocity
            Angular velocity (rad/s) there.
        recording
            The recording whose start and clock are used. Default: the first.
        noise, seed
            Standard deviation (rad; rad/s of an angular rate) and seed of the noise to add.

        Returns
        -------
        xarray.DataArray
            ``angle`` (rad) or ``rate`` (rad/s), of shape (time,).

        Raises
        ------
        InputError
            If times precede the recording, the recording is unknown, or there is no model.
        """
        name = next(iter(self.begins), "") if recording is None else recording
        if name not in self.begins:
            raise InputError(f"recording {name!r}", "the answer has none of that name", ", ".join(self.begins) or "a swing")  # fmt: skip
        begin, model = self.begins[name], self.model
        if model.drifts and not model.record:
            model = replace(model, record=begin.duration)
        if times is None:
            times = next(one["time"].values for one in self.swings if one.attrs["recording"] == name)
        at = (begin.time, begin.angle, begin.velocity) if angle is None else (None, angle, velocity)
        return swing_of(model, times, at, noise, seed)

    def __repr__(self) -> str:
        sentence, *rest = lines(self.row, self.verdict, self.catalogue, self.restoring)
        return "\n".join([sentence, *self._as_given, *rest])

    def plot(self, what: Literal["swings", "curves", "laws"] = "swings") -> "Drawn":
        """A matplotlib Figure, which a notebook shows.

        Parameters
        ----------
        what
            ``swings`` with the fit and the residual; ``curves`` against the amplitude; ``laws`` of damping over the envelope of
            the largest swing.

        Raises
        ------
        InputError
            If only passages without speeds are given: they hold no angle. Also as of ``curves`` and ``laws``.
        """
        needed("matplotlib")
        if what in ("curves", "laws"):
            from ..plots.curves import backbone, envelopes

            return backbone(self.curves()) if what == "curves" else envelopes(self._envelopes())
        if what != "swings":
            raise InputError("plot", f"there is no picture {what!r}", "swings, curves or laws")
        if not self.shown:
            raise InputError("plot", "passages without speeds hold no angle", _WITH_ANGLES)
        from ..plots.answer import swings_with_fit

        noise = noise_rms(self.verdict) if self.verdict else None
        return swings_with_fit(self.shown, noise, {"emulated": self.row["emulated"]}, short(self.row))

    def to_dataframe(self) -> pd.DataFrame:
        """A DataFrame with a row for each quantity.

        Returns
        -------
        pandas.DataFrame
            Columns ``value``, ``u`` (standard uncertainty), ``unit``, ``text`` and ``holds`` (at which amplitude), over ``quantity``.
        """
        rows = quantity_rows(self.row, self.verdict)
        told = [(one.name, one.value, one.uncertainty, one.unit, one.number, one.condition) for one in rows]
        columns = ["quantity", "value", "u", "unit", "text", "holds"]
        return pd.DataFrame(told, columns=columns).set_index("quantity")

    def to_xarray(self) -> xr.Dataset:
        """A Dataset of the samples with fit and residual, and of the quantities.

        Returns
        -------
        xarray.Dataset
            Over ``sample``: ``angle`` (rad) or ``rate`` (rad/s), ``fit``, ``residual``, with ``time`` (s) and ``recording``. Over
            ``quantity``: ``value`` and ``standard_uncertainty``, with ``unit``. No samples where passages hold no angle.
        """
        rows = quantity_rows(self.row, self.verdict)
        found = xr.Dataset(
            {
                "value": ("quantity", [one.value for one in rows]),
                "standard_uncertainty": ("quantity", [one.uncertainty for one in rows]),
            },
            {"quantity": [one.name for one in rows], "unit": ("quantity", [one.unit for one in rows])},
            {"sentence": self.sentence, "model": self.label, "emulated": str(self.row["emulated"])},
        )
        if not self.shown:
            return found
        fitted = np.concatenate([one.fit for one in self.shown])
        names = Shown.by_recording(self.shown)
        swings = [one for name in names for one in self.swings if one.attrs["recording"] == name]
        samples = samples_of(swings, fit=fitted)
        samples["residual"] = next(iter(samples.data_vars.values())) - samples["fit"]
        samples["residual"].attrs = dict(samples["fit"].attrs)
        return samples.merge(found).assign_attrs(found.attrs)

    def curves(self) -> xr.Dataset:
        """A Dataset of period, loss, damping and torques against amplitude, angle and speed, with bands of 95 %.

        Returns
        -------
        xarray.Dataset
            As ``curves.dataset.curves``: free of a model, and of the model.

        Raises
        ------
        InputError
            If there are fewer than eight half-swings, or only passages without speeds.
        """
        check_free(self.swings, CURVES)
        model, covariance = self.fitted or (None, None)
        return curves_of(self.swings, model, covariance, self.restoring)

    def resonance(self, drive: ArrayLike | None = None, kind: str = "torque") -> xr.Dataset:
        """A Dataset of amplitude and phase of the steady swing against the frequency of a drive, predicted from the ring-down.

        Parameters
        ----------
        drive
            Amplitudes of the drive in rad/s², of shape (drive,). Default: some that suit the ring-down.
        kind
            ``torque`` (over the inertia), or ``pivot`` (sideways acceleration of the pivot over the length).

        Returns
        -------
        xarray.Dataset
            As ``curves.resonance.resonance``; ``plots.curves.resonances`` draws it.

        Raises
        ------
        InputError
            If the drive is too weak for the amplitudes of the ring-down.
        """
        return resonance(self.curves(), drive, kind)

    def laws(self) -> list[Laws]:
        """The residual and the evidence of each law of damping, for each recording.

        Returns
        -------
        list of Laws
            As ``curves.laws.laws``; ``curves.laws.table`` makes a table of them.

        Raises
        ------
        InputError
            If only passages without speeds are given.
        """
        check_free(self.swings, LAWS)
        known = [self.fits.isel(recording=k) for k in range(len(self.swings))]
        pairs = zip(self.swings, known, strict=True)
        return [laws(angle, one, self.restoring, self.catalogue) for angle, one in pairs]

    def _envelopes(self) -> xr.Dataset:
        """The turning points of the largest swing with the laws of damping over them, and whether the decay is exponential."""
        try:
            curves = self.curves()
        except InputError:  # too few half-swings for curves are enough for a sentence
            curves = None
        return envelopes_of(self.laws(), curves, str(self.row["emulated"]))

    def to_dict(self) -> dict[str, Any]:
        """The answer in plain numbers, texts and lists.

        Returns
        -------
        dict
            Sentence, quantities with standard uncertainty and unit, model, verdict; what is not known is None.
        """
        row, (residual, unit) = self.row, residual_of(self.row)
        return {
            "sentence": self.sentence,
            "recordings": [str(one.attrs["recording"]) for one in self.swings],
            "amplitude_rad": finite_or_none(row["amplitude_rad"]),
            "quantities": {
                one.name: {
                    "value": one.value,
                    "standard_uncertainty": finite_or_none(one.uncertainty),
                    "unit": one.unit,
                    "text": one.number,
                    "holds": one.condition,
                }
                for one in quantity_rows(row, self.verdict)
            },
            "model": self.label,
            "or_models": or_models(row),
            "timed": by_stop_watch(self.shown, self.table),
            "residual": {"value": finite_or_none(residual), "unit": unit},
            "residual_rad": finite_or_none(row["residual_rad"]) if unit == "rad" else None,
            "emulated": row["emulated"] == "yes",
            "remarks": self.remarks,
            "verdict": dict(self.verdict) if self.verdict else None,
        }

    def _repr_html_(self) -> str:
        rows = [
            [one.words, one.number, "" if one.unit == "1" else one.unit, one.condition]
            for one in quantity_rows(self.row, self.verdict)
        ]  # fmt: skip
        said = [*self.remarks, *lines(self.row, self.verdict)[-1:]] if self.verdict else self.remarks
        picture = self.plot() if self.shown and has("matplotlib") else None
        return markup.page(said, markup.table([], rows), picture, self.sentence)
