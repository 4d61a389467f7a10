"""The catalogue of effects: an immutable value that is handed on. An entry gives an effect all that is known of it.

The entries stand by kind in the modules beside this one. ``catalogue(own)`` is the catalogue of a study that has effects
of its own; a ``Model`` knows the catalogue that it is built from.
"""

import json
import math
from collections.abc import Iterator, Mapping
from functools import lru_cache
from types import MappingProxyType
from typing import Any

from ...errors import InputError
from ...schema import check
from ..effect import NATURAL_FREQUENCY, Effect, Parameter
from ..formula import evaluate
from ..own import own_effects
from .clock import CLOCK
from .dissipation import DISSIPATION
from .drive import DRIVE
from .inputs import INPUTS
from .restoring import GRAVITY, RESTORING
from .sensor import GYROSCOPE, SENSOR

ENTRIES: tuple[Effect, ...] = (*DISSIPATION, *RESTORING, *DRIVE, *SENSOR, *CLOCK)
ANGLE, RATE = "angle", "rate"
READINGS = {ANGLE: "rad", RATE: "rad/s"}
"""What a sensor may read of a pendulum, and its unit: the angle, or the angular velocity."""


class Catalogue:
    """The effects a pendulum may have, by name and in the order in which models list them; it never changes.

    Iterating gives the effects that a search may name.

    Parameters
    ----------
    entries
        These effects.
    where
        What to call the catalogue where an effect cannot be in it.
    whole
        The catalogue of angles that one of angular rates is part of.

    Attributes
    ----------
    names
        Of the effects that a search may name.
    inputs
        Torques of a measured drive, which models may have too.
    reading
        What a sensor reads, a key of ``READINGS``: it decides what a sensor may have wrong.

    Raises
    ------
    InputError
        For two effects or two parameters of one name.
    """

    def __init__(
        self,
        entries: tuple[Effect, ...] = ENTRIES,
        where: str = "catalogue",
        whole: "Catalogue | None" = None,
    ) -> None:
        self.reading = ANGLE if whole is None else RATE
        self.whole: Catalogue = self if whole is None else whole
        self._of_rates: Catalogue | None = self if whole else None
        self.gravity: Mapping[str, Effect] = GRAVITY
        self.inputs: tuple[Effect, ...] = INPUTS
        self.names = tuple(effect.name for effect in entries)
        self._known: dict[str, Effect] = {}
        taken = {effect.name for effect in self.gravity.values()}
        for effect in (*entries, *self.inputs):
            if effect.name in self._known or effect.name in taken:
                raise InputError(
                    f"{where}.{effect.name}", f"the catalogue has an effect {effect.name!r}", "a name of its own", "rename it"
                )  # fmt: skip
            self._known[effect.name] = effect
        self._places = {name: place for place, name in enumerate(self._known)}
        self._parameters: dict[str, Parameter] = {NATURAL_FREQUENCY.name: NATURAL_FREQUENCY}
        for effect in self._known.values():
            for parameter in effect.parameters:
                if parameter.name in self._parameters and not (
                    effect in self.inputs and parameter == self._parameters[parameter.name]
                ):
                    raise InputError(
                        f"{where}.{effect.name}", f"the catalogue has a parameter {parameter.name!r}",
                        "a name that no other effect's parameter has", "rename the effect or the symbol",
                    )  # fmt: skip
                self._parameters[parameter.name] = parameter

    def __iter__(self) -> Iterator[Effect]:
        return (self._known[name] for name in self.names)

    def __len__(self) -> int:
        return len(self.names)

    def __contains__(self, name: object) -> bool:
        return name in self._known

    def __repr__(self) -> str:
        return f"Catalogue of {', '.join(self.names)}"

    def __getitem__(self, name: str) -> Effect:
        """The effect of that name; InputError with the known names otherwise."""
        if name not in self._known and self.reading == RATE and name in self.whole:
            raise InputError(
                f"effect {name!r}", "it belongs to a sensor of angles, and the recording is of an angular rate", ", ".join(self.names),
                "leave it out for this recording",
            )  # fmt: skip
        if name not in self._known:
            raise InputError(f"effect {name!r}", "no such effect in the catalogue", ", ".join(self.names))
        return self._known[name]

    @property
    def known(self) -> tuple[Effect, ...]:
        """Every effect a model may have, those of a measured drive last."""
        return tuple(self._known.values())

    @property
    def parameters(self) -> Mapping[str, Parameter]:
        """Every parameter a model may have by name: the natural frequency, then those of the effects in order."""
        return MappingProxyType(self._parameters)

    def ordered(self, names: Any) -> tuple[str, ...]:
        """The names in the catalogue's order.

        Parameters
        ----------
        names
            Of effects, in any order.

        Raises
        ------
        InputError
            If a name is unknown.
        """
        return tuple(sorted(names, key=lambda name: self._places[self[name].name]))

    def of(self, reading: str) -> "Catalogue":
        """The catalogue for recordings of a reading: that of rates has the errors of a gyroscope in place of an angle sensor's.

        Parameters
        ----------
        reading
            ``angle`` or ``rate``.

        Raises
        ------
        InputError
            If the reading is unknown.
        """
        if reading not in READINGS:
            raise InputError("reading", f"unknown reading {reading!r}", " or ".join(READINGS))
        if reading == ANGLE:
            return self.whole
        if self._of_rates is None:
            own = {effect.name: effect for effect in GYROSCOPE}
            of_angles = {effect.name for effect in SENSOR} - set(own)
            entries = tuple(own.get(one.name, one) for one in self if one.name not in of_angles)
            self._of_rates = Catalogue(entries, whole=self)
        return self._of_rates

    def without(self, *names: str) -> "Catalogue":
        """The catalogue that lacks these effects.

        Parameters
        ----------
        names
            Of effects; one that is not there is passed over.
        """
        kept = tuple(effect for effect in self if effect.name not in names)
        return Catalogue(kept, whole=self.whole if self.reading == RATE else None)

    def with_effects(self, *effects: Effect, where: str = "catalogue") -> "Catalogue":
        """The catalogue that has these effects too, after its own.

        Parameters
        ----------
        effects
            With names that are not taken.
        where
            What errors call them.

        Raises
        ------
        InputError
            If the name of an effect or of a parameter is taken.
        """
        if self.reading == RATE:
            return self.whole.with_effects(*effects, where=where).of(RATE)
        return Catalogue((*self, *effects), where)

    def contained_in(self, name: str) -> tuple[str, ...]:
        """The names of the simpler effects that an effect becomes at some value of its shape."""
        return tuple(one.name for one in self[name].contains)

    def damps(self, name: str) -> bool:
        """True for an effect that takes energy from a swing: its entry says how, or that of a simpler effect that it becomes."""
        return any(self[one].damping for one in (name, *self.contained_in(name)))

    def rubs(self, name: str) -> bool:
        """True for a friction: its torque is left as the speed goes to nothing, or it becomes such an effect where its memory is short."""
        effect = self[name]
        return effect.rubs or (bool(effect.states) and any(self[one].rubs for one in self.contained_in(name)))

    def powers_lost(self, name: str) -> frozenset[int]:
        """The powers of the amplitude as which an effect takes from it: of viscous drag 1; of one that becomes others, theirs as well."""
        formulas = (self[one].damping for one in (name, *self.contained_in(name)))
        sizes = [
            [evaluate(one, loss=1.0, amplitude=a, omega_n=1.0) for a in (1.0, 2.0)] for one in formulas if one
        ]
        return frozenset(round(math.log2(small / large)) for small, large in sizes)

    def measurement(self, one: str, other: str) -> str | None:
        """The measurement that tells two effects apart, as a sentence, or None where none is known.

        Parameters
        ----------
        one, other
            Names of effects, in either order.
        """
        return self[one].told_apart.get(other) or self[other].told_apart.get(one)


SHIPPED = Catalogue()


def catalogue(own: Mapping[str, Any] | None = None, where: str = "config, key effects") -> Catalogue:
    """The ``Catalogue`` with a study's own effects after the shipped ones; the same settings give the same object.

    Parameters
    ----------
    own
        The settings' key ``effects``.
    where
        What errors call it.

    Raises
    ------
    InputError
        As of ``own_effects`` and ``Catalogue``.
    """
    return _with_own(json.dumps(own, default=_as_list), where) if own else SHIPPED


def _as_list(value: Any) -> Any:
    """Numbers and arrays of numpy as Python's; any other object as text, which is refused where a number belongs."""
    return value.tolist() if hasattr(value, "tolist") else str(value)


@lru_cache(maxsize=20)
def _with_own(own: str, where: str) -> Catalogue:
    effects = check({"effects": json.loads(own)}, "config.schema.yaml", where.partition(", key ")[0])[
        "effects"
    ]
    return SHIPPED.with_effects(*own_effects(effects, where), where=where)
