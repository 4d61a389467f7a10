"""A pendulum model: the effects it has, their values and standard errors."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import combinations
from math import nan
from typing import Any

from .. import markup
from ..errors import InputError
from ..language import listed
from ..rounding import value_with_uncertainty
from .catalogue import ANGLE, SHIPPED, Catalogue, catalogue
from .catalogue.restoring import GRAVITY
from .drive import Drive
from .effect import NATURAL_FREQUENCY, Effect, Parameter
from .slack import Slack

FORMS = ("consistent", "printed")
RESTORING = tuple(GRAVITY)
_TABLE_1 = ("viscous", "quadratic_drag", "load_coulomb")
PAPER_MODELS = tuple("+".join(terms) for size in (1, 2, 3) for terms in combinations(_TABLE_1, size))
# What a search starts from, by what pulls back; `discovery.base` of the settings is the first. No weight loads a wheel's bearing.
BASES = {"sine": ("viscous", "load_coulomb"), "linear": ("viscous", "constant_coulomb")}
# Air of any speed, material that bends, and a bearing that winds up before it slips.
_BESIDE = ("power_law_drag", "structural_damping", "viscous+presliding")


def everyday(restoring: str = "sine") -> tuple[str, ...]:
    """The labels of the laws of damping that a benchtop pendulum may have: the paper's, and what else air, bearings and material do.

    No weight loads the bearing of a wheel on a spring: beside a linear restoring torque its dry friction is constant.

    Parameters
    ----------
    restoring
        ``sine`` or ``linear``.

    Returns
    -------
    tuple of str
        Such as ``viscous+load_coulomb``.
    """
    own = "load_coulomb" if restoring == "sine" else "constant_coulomb"
    return (*(label.replace("load_coulomb", own) for label in PAPER_MODELS), *_BESIDE)


@dataclass(frozen=True)
class Model:
    """A pendulum with chosen effects: ``theta'' = gravity + the sum of its torques``, and what its sensor does.

    Parameters
    ----------
    names
        A label such as ``viscous+load_coulomb``, or a sequence of names. They are kept in the order of the catalogue.
    values, standard_errors
        By parameter name, in each parameter's unit.
    restoring
        ``sine`` or ``linear``.
    form
        ``consistent``, or ``printed`` (the paper's Table 1 to the letter).
    catalogue
        The catalogue that the effects are taken from.
    slack
        What the measurement leaves open of the reading. Its effects act, but belong neither to ``names`` nor to ``label``, unless
        they are named.
    record
        The ``duration`` (s) in formulas, the same for all recordings, so that a drift is one in time. None: each recording's own.
    own_frequency
        Whether each recording has a natural frequency of its own, as of a pendulum that was taken down between them.
    own
        Other parameters that each recording has for itself.
    drive
        What was measured of what drives it, in the clock of the times at which it is followed.

    Raises
    ------
    InputError
        If an effect, form or parameter is unknown.
    """

    names: tuple[str, ...]
    values: dict[str, float] = field(default_factory=dict)
    standard_errors: dict[str, float] = field(default_factory=dict)
    restoring: str = "sine"
    form: str = "consistent"
    catalogue: Catalogue = field(default=SHIPPED, repr=False, compare=False)
    slack: Slack = field(default_factory=Slack, repr=False, compare=False)
    record: float | None = field(default=None, repr=False, compare=False)
    own_frequency: bool = False
    own: tuple[str, ...] = ()
    drive: Drive | None = field(default=None, repr=False, compare=False)

    def __post_init__(self) -> None:
        given: Any = self.names  # a label too
        names = given.split("+") if isinstance(given, str) else list(given)
        ordered = self.catalogue.ordered(names)
        if len(set(names)) < len(names):
            raise InputError(f"model {'+'.join(names)}", "an effect is named twice", "each effect once")
        object.__setattr__(self, "names", ordered)
        object.__setattr__(self, "slack", self.slack.without(ordered))
        for key, value, known in (("restoring", self.restoring, RESTORING), ("form", self.form, FORMS)):
            if value not in known:
                raise InputError(f"model {self.label}, {key}", f"unknown {key} {value!r}", " or ".join(known))
        self._check((*self.values, *self.standard_errors))

    def __str__(self) -> str:
        return self.label

    def _repr_html_(self) -> str:
        told = {
            name: value_with_uncertainty(value, self.standard_errors.get(name, nan))
            for name, value in self.values.items()
        }
        rows = [[name.replace("_", " "), number, self.units[name]] for name, number in told.items()]
        return markup.page([], markup.table([], rows), lead=self.label)

    def _check(self, names: Iterable[str]) -> None:
        known = self.parameters
        for name in names:
            if name not in known:
                raise InputError(f"model {self.label}", f"no parameter {name!r}", ", ".join(known))

    @property
    def label(self) -> str:
        """The effects' names joined by ``+``, in catalogue order."""
        return "+".join(self.names)

    @cached_property
    def effects(self) -> tuple[Effect, ...]:
        """The effects, in catalogue order, without those of the slack."""
        return tuple(self.catalogue[name] for name in self.names)

    @cached_property
    def acting(self) -> tuple[Effect, ...]:
        """All that acts on the reading or the motion, in catalogue order: the effects and those of the slack."""
        names = self.catalogue.ordered((*self.names, *self.slack.names))
        return tuple(self.catalogue[name] for name in names)

    @property
    def reading(self) -> str:
        """What its sensor reads: ``angle`` (rad) or ``rate`` (rad/s), as its catalogue says."""
        return self.catalogue.reading

    def of(self, reading: str) -> "Model":
        """The same pendulum with a sensor of another reading.

        Parameters
        ----------
        reading
            ``angle`` (rad) or ``rate`` (rad/s).

        Raises
        ------
        InputError
            If the model has an effect that such a sensor cannot have.
        """
        return self if reading == self.reading else replace(self, catalogue=self.catalogue.of(reading))

    @property
    def motion(self) -> "Model":
        """The same pendulum without what sensor, clock and slack do: what it reads is the angle itself."""
        names = tuple(one.name for one in self.effects if one.acts_on == "torque")
        bare = Model(
            names, {}, {}, self.restoring, self.form, self.catalogue.of(ANGLE), record=self.record, drive=self.drive
        )  # fmt: skip
        kept = {name: value for name, value in self.values.items() if name in bare.parameters}
        return bare.with_values(kept)

    @property
    def takes_input(self) -> bool:
        """True where a measured drive acts in it."""
        return any(effect.takes_input for effect in self.effects)

    def driven_by(self, drive: Drive | None) -> "Model":
        """The same model under another drive.

        Parameters
        ----------
        drive
            As ``pendulum.drive.drive`` returns it; None for a free swing.
        """
        return self if drive is self.drive else replace(self, drive=drive)

    def under(self, drive: Drive | None) -> "Model":
        """The model with the effect by which a measured drive acts.

        Parameters
        ----------
        drive
            As of ``driven_by``; None, of a free swing, gives the model itself.
        """
        return self.with_effects((*self.names, drive.effect)).driven_by(drive) if drive else self

    @property
    def gravity(self) -> Effect:
        """The restoring torque of its weight."""
        return self.catalogue.gravity[self.restoring]

    @cached_property
    def definitions(self) -> tuple[Parameter, ...]:
        """The definitions of all parameters, the natural frequency first."""
        return (NATURAL_FREQUENCY, *(parameter for effect in self.acting for parameter in effect.parameters))

    @cached_property
    def parameters(self) -> tuple[str, ...]:
        """The parameters' names, the natural frequency first."""
        return tuple(parameter.name for parameter in self.definitions)

    @property
    def each(self) -> tuple[str, ...]:
        """The names of the parameters that each recording has for itself."""
        frequency = (NATURAL_FREQUENCY.name,) if self.own_frequency else ()
        own = (name for name in self.own if name in self.parameters)
        return (*frequency, *own, *(name for effect in self.effects for name in effect.each))

    @property
    def drifts(self) -> bool:
        """True where something in it changes over the record."""
        return any("duration" in effect.term for effect in self.effects)

    @property
    def units(self) -> dict[str, str]:
        """The unit of each parameter, by name."""
        return {parameter.name: parameter.unit for parameter in self.definitions}

    def with_values(
        self, values: Mapping[str, float], standard_errors: Mapping[str, float] | None = None
    ) -> "Model":
        """The same model with other values and standard errors.

        Parameters
        ----------
        values, standard_errors
            By parameter name, in each parameter's unit (``units``). They replace all that the model has.

        Raises
        ------
        InputError
            If the model has no parameter of a name; it lists those that it has.
        """
        errors = dict(standard_errors or {})
        self._check((*values, *errors))
        found = object.__new__(type(self))
        # all else was checked
        found.__dict__.update(self.__dict__, values=dict(values), standard_errors=errors)
        return found

    def with_effects(self, names: Sequence[str], values: Mapping[str, float] | None = None) -> "Model":
        """A model of the same catalogue, restoring torque, form and slack with these effects and values.

        Parameters
        ----------
        names
            Effects of the catalogue, in any order.
        values
            By parameter name, in each parameter's unit. Default: none.

        Raises
        ------
        InputError
            If an effect or a parameter is unknown.
        """
        return replace(self, names=tuple(names), values=dict(values or {}), standard_errors={})

    def with_slack(self, slack: Slack) -> "Model":
        """The same model of a measurement that leaves this open.

        Parameters
        ----------
        slack
            Values of nuisance parameters that it lacks are dropped, those that it adds are 0.
        """
        bare = replace(self, values={}, standard_errors={}, slack=slack)
        values, errors = ({name: value for name, value in given.items() if name in bare.parameters}
                          for given in (self.values, self.standard_errors))  # fmt: skip
        return bare.with_values(dict.fromkeys(bare.slack.parameters, 0.0) | values if values else {}, errors)

    def vector(self) -> list[float]:
        """The values, each in its parameter's unit, in the order of ``parameters``; a start of which nothing is said is 0.

        Raises
        ------
        InputError
            If values are missing; it names them.
        """
        values = {one.name: one.usual for one in self.definitions if one.role == "start"} | dict(self.values)
        if lost := [name for name in self.parameters if name not in values]:
            problem = f"no value for {', '.join(lost)}"
            raise InputError(f"model {self.label}", problem, "a value for each parameter")
        return [float(values[name]) for name in self.parameters]


def as_model(model: Model | str | Sequence[str]) -> Model:
    """The model itself, or that of a label, of the shipped catalogue.

    Parameters
    ----------
    model
        A ``Model``, a label such as ``viscous+load_coulomb``, or a sequence of names.

    Raises
    ------
    InputError
        If an effect is unknown.
    """
    return model if isinstance(model, Model) else Model(model)  # type: ignore[arg-type]


def models(
    labels: str | Iterable[str],
    own: Mapping[str, Any] | None = None,
    restoring: str = "sine",
    form: str = "consistent",
) -> list[Model]:
    """The models of these labels, from the catalogue with a study's own effects.

    Parameters
    ----------
    labels
        Such as ``viscous+load_coulomb``; one, or several.
    own
        The settings' key ``effects``.
    restoring, form
        As of ``Model``, and so are the errors.
    """
    entries = catalogue(own)
    labels = [labels] if isinstance(labels, str) else labels
    return [Model(label, {}, {}, restoring, form, entries) for label in labels]  # type: ignore[arg-type]


def symbol(label: str, mathtext: bool = False) -> str:
    """The model's symbol as in the paper: ``κv,q`` for ``viscous+quadratic_drag``, in mathtext on request.

    An effect that has no letter of its own, one of a study's own included, is told by its name.
    """
    letters = ",".join(
        (name in SHIPPED and SHIPPED[name].symbol) or name.replace("_", " ") for name in label.split("+")
    )
    return rf"$\kappa_{{{letters}}}$".replace(" ", r"\ ") if mathtext else f"κ{letters}"


def in_words(name: object) -> str:
    """A name of an effect, a move or a model as one says it: Coulomb was a person."""
    return str(name).replace("_", " ").replace("coulomb", "Coulomb")


def model_words(label: str) -> str:
    """A model's effects in words: ``viscous and load Coulomb``; a measured drive is none of its own."""
    drives = {effect.name for effect in SHIPPED.inputs}
    names = [in_words(name) for name in label.split("+") if name not in drives]
    return listed(names)
