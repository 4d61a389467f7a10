"""An answer on one pendulum: it prints itself, draws itself, simulates, and goes to a table, a dataset or a dict."""

import base64
import io
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from html import escape
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import ArrayLike

from ..arrays import Shown
from ..curves.chosen import Fitted, of_verdict
from ..curves.dataset import curves as curves_of
from ..curves.laws import Laws, laws
from ..curves.resonance import resonance
from ..discovery.verdict import noise_rms
from ..errors import InputError
from ..pendulum.catalogue import SHIPPED, Catalogue
from ..pendulum.model import Model
from ..rounding import value_with_uncertainty
from ..studies.pendulums import by_verdict, in_order, residual_of
from ..studies.quantities import Quantity
from ..studies.words import headline, lines, or_models, quantity_rows, short
from .recorded import samples_of
from .simulation import swing_of

if TYPE_CHECKING:
    from ..plots.style import Drawn


class Begin(NamedTuple):
    """How a swing begins as it was fitted: time (s) of its first sample, angle (rad) and angular velocity (rad/s) there, its length (s)."""

    time: float
    angle: float
    velocity: float
    duration: float


@dataclass(frozen=True)
class Answer:
    """What was found of one pendulum.

    ``swings``: its angles (rad) as datasets, the release cut off where it was held in a hand. ``fits``: every model of damping
    fitted to each swing (``studies.experiment``). ``table``: a row for each swing, and one for all together where there are
    several, as ``studies.pendulums`` makes them. ``fitted``: the model that describes it, with the covariance of its parameters. ``verdict``:
    as verdict.json has it; None after ``fit``. ``begins``: how each swing begins, by the name of its recording.
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
        """The table's row of the pendulum: of its swing, or of all its swings together."""
        return self.table.iloc[-1].to_dict()

    @property
    def model(self) -> Model:
        """The model that describes the pendulum, with its fitted values and standard errors; InputError where passages alone tell none."""
        if self.fitted_model is None:
            raise InputError("model", f"the damping is {self.label}", "a swing, turning points, or passages with speeds")  # fmt: skip
        return self.fitted_model

    @property
    def label(self) -> str:
        """What the answer's table calls its model: names joined by ``+``, or why the damping cannot be told."""
        return str(self.row["model"])

    @property
    def sentence(self) -> str:
        """What stops the pendulum, its period and its quality, in a sentence."""
        return headline(self.row, self.verdict, self.catalogue, self.restoring)

    @property
    def restoring(self) -> str:
        """What pulls it back: ``sine`` or ``linear``."""
        return str(self.fits.attrs.get("restoring", "sine"))

    @property
    def quantities(self) -> dict[str, Quantity]:
        """Each quantity by name, with ``value``, ``u`` (standard uncertainty) and ``unit``; at the amplitude ``row["amplitude_rad"]``."""
        return {one.name: one.quantity for one in quantity_rows(self.row, self.verdict)}

    def __getitem__(self, name: str) -> Quantity:
        """The quantity of that name: ``answer["period"]``; InputError with the known names otherwise."""
        found = self.quantities
        if name not in found:
            raise InputError(f"quantity {name!r}", "the answer has none of that name", ", ".join(found))
        return found[name]

    @property
    def remarks(self) -> list[str]:
        """What is to be known of the swings as given and of what is said of them, a line each."""
        doubts = [str(row["remark"]) for row in self.table.to_dict("records") if row["remark"]]
        return [*self._as_given, *dict.fromkeys(doubts)]

    @property
    def _as_given(self) -> list[str]:
        told = [
            (one.attrs["recording"], one.attrs["remarks"]) for one in self.swings if one.attrs.get("remarks")
        ]
        return [f"{name}: {text}" for name, text in told]

    def with_verdict(self, found: Mapping[str, Any], shown: tuple[Shown, ...] = ()) -> "Answer":
        """The same answer with a verdict, and with what its last model makes of the swings, where that is given."""
        table = self.table.copy().astype(object)
        row = by_verdict(self.table.iloc[-1].to_dict(), found)
        table = pd.concat([table.iloc[:-1], pd.DataFrame([row])], ignore_index=True)
        fitted = of_verdict(found, self.restoring, self.catalogue) or self.fitted
        return replace(self, verdict=found, shown=shown or self.shown, table=in_order(table), fitted=fitted)

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
        """The swing of the answer's model at these times (s; by default those of the recording) as a DataArray in rad, of an angular rate in rad/s.

        Without an ``angle`` it goes on as the ``recording`` (by default the first) begins, whose clock the times are of. With one it is let go from there (rad)
        at the first of the times, at ``velocity`` (rad/s). ``noise`` (rad) is the standard deviation of what is added, drawn by ``seed``.
        InputError for times before the recording, for a recording that is not there, and where there is no model.
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

    def __str__(self) -> str:
        sentence, *rest = lines(self.row, self.verdict, self.catalogue, self.restoring)
        return "\n".join([sentence, *self._as_given, *rest])

    def __repr__(self) -> str:
        return str(self)

    def plot(self) -> "Drawn":
        """A matplotlib Figure that a notebook draws: the swings with the fit, and what it leaves. InputError for passages without speeds: they hold no angle."""
        if not self.shown:
            raise InputError(
                "plot",
                "passages without speeds hold no angle",
                "a swing, turning points, or passages with speeds",
            )
        from ..plots.answer import swings_with_fit

        noise = noise_rms(self.verdict) if self.verdict else None
        return swings_with_fit(self.shown, noise, {"emulated": self.row["emulated"]}, short(self.row))

    def to_dataframe(self) -> pd.DataFrame:
        """A row for each quantity, by name: ``value``, ``u`` (standard uncertainty), ``unit``, ``text``, and at which amplitude it ``holds``."""
        rows = quantity_rows(self.row, self.verdict)
        columns = {
            "value": [one.value for one in rows],
            "u": [one.uncertainty for one in rows],
            "unit": [one.unit for one in rows],
            "text": [value_with_uncertainty(one.value, one.uncertainty) for one in rows],
            "holds": [one.condition for one in rows],
        }
        return pd.DataFrame(columns, index=pd.Index([one.name for one in rows], name="quantity"))

    def to_xarray(self) -> xr.Dataset:
        """The samples (``angle``, of an angular rate ``rate``; ``fit``, ``residual``; with ``time`` in s and ``recording``) over ``sample``, and ``value`` and
        ``standard_uncertainty`` over ``quantity``, with units. Without samples where passages hold no angle."""
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
        names = list(dict.fromkeys(one.recording for one in self.shown))
        swings = [one for name in names for one in self.swings if one.attrs["recording"] == name]
        samples = samples_of(swings, fit=fitted)
        samples["residual"] = next(iter(samples.data_vars.values())) - samples["fit"]
        samples["residual"].attrs = dict(samples["fit"].attrs)
        return samples.merge(found).assign_attrs(found.attrs)

    def curves(self) -> xr.Dataset:
        """Period, loss, damping and torques against amplitude, angle and speed, free of a model and of the model, with bands of 95 %.

        The Dataset is that of ``curves.dataset.curves``. InputError for fewer than eight half-swings, and for passages without speeds.
        """
        model, covariance = self.fitted or (None, None)
        return curves_of(self.swings, model, covariance, self.restoring)

    def resonance(self, drive: ArrayLike | None = None, kind: str = "torque") -> xr.Dataset:
        """Amplitude and phase of the steady swing against the frequency of a drive (rad/s²), as this ring-down foretells them.

        Arguments, Dataset and errors are those of ``curves.resonance.resonance``; ``plots.curves.resonances`` draws it.
        """
        return resonance(self.curves(), drive, kind)

    def laws(self) -> list[Laws]:
        """What each law of damping leaves of each recording, as ``curves.laws.laws`` gives it; ``curves.laws.table`` makes a table of it.

        InputError for passages without speeds.
        """
        known = [self.fits.isel(recording=k) for k in range(len(self.swings))]
        pairs = zip(self.swings, known, strict=True)
        return [laws(angle, one, self.restoring, self.catalogue) for angle, one in pairs]

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers, texts and lists: sentence, quantities, model, verdict."""
        row = self.row
        return {
            "sentence": self.sentence,
            "recordings": [str(one.attrs["recording"]) for one in self.swings],
            "amplitude_rad": _known(row["amplitude_rad"]),
            "quantities": {
                one.name: {
                    "value": one.value,
                    "standard_uncertainty": _known(one.uncertainty),
                    "unit": one.unit,
                    "text": value_with_uncertainty(one.value, one.uncertainty),
                }
                for one in quantity_rows(row, self.verdict)
            },
            "model": self.label,
            "or_models": or_models(row),
            "residual": {"value": _known(residual_of(row)[0]), "unit": residual_of(row)[1]},
            "residual_rad": _known(row["residual_rad"]) if residual_of(row)[1] == "rad" else None,
            "emulated": row["emulated"] == "yes",
            "remarks": self.remarks,
            "verdict": dict(self.verdict) if self.verdict else None,
        }

    def _repr_html_(self) -> str:
        picture = io.BytesIO()
        if self.shown:
            self.plot().savefig(picture, format="png", dpi=110)
        source = base64.b64encode(picture.getvalue()).decode()
        image = f"<img alt='the swings with the fit' src='data:image/png;base64,{source}'>" if source else ""
        rows = "".join(
            f"<tr><td style='text-align:left'>{escape(one.words)}</td>"
            f"<td>{escape(value_with_uncertainty(one.value, one.uncertainty))}</td>"
            f"<td style='text-align:left'>{escape('' if one.unit == '1' else one.unit)} {escape(one.condition)}</td></tr>"
            for one in quantity_rows(self.row, self.verdict)
        )
        said = [*self.remarks, *lines(self.row, self.verdict)[-1:]] if self.verdict else self.remarks
        first = f"<p><b>{escape(self.sentence)}</b></p>"
        return first + "".join(f"<p>{escape(line)}</p>" for line in said) + f"<table>{rows}</table>{image}"


def _known(value: float) -> float | None:
    """The number, or None where it is not known: JSON has none for that."""
    return float(value) if np.isfinite(value) else None
