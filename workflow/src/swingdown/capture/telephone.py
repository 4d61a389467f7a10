"""A telephone as a source: the gyroscope of an experiment in phyphox, over the app's remote interface.

``capture.port: phyphox://HOST[:PORT]``, the address that phyphox shows under "Allow remote access". What is read is told by the
experiment itself (``/config``): buffers of a gyroscope (rad/s) and of its time (s), those that the experiment exports. The telephone
keeps all samples and is asked a few times a second for those since the last (phyphox.org/wiki, "Remote-interface communication"), so that a
network that drops for some seconds loses none. Its clock stands still in a pause: what it lists of starts and pauses (``/time``) shows one.
"""

import contextlib
import http.client
import json
import math
import time
import urllib.error
import urllib.parse
import urllib.request
from collections.abc import Mapping, Sequence
from operator import itemgetter
from typing import Any, NamedTuple

import numpy as np

from ..errors import InputError
from .formats import Timed

UNIT = "rad/s"
PORT = 8080  # phyphox's own; on an iPhone it is 80
PATIENCE = 20.0  # s without an answer, after which the telephone is gone
_ANSWER = 2.0  # s that one answer may take
_TRIES = 3  # to reach it at first
_POLL = 0.1  # s between questions; the app's server does one thing at a time
_LOOK = 1.5  # s of samples that tell the rate, and the axis
_STARTS = 5.0  # s that its sensor may take to give them
_ENOUGH = 20  # samples of a look
_MOVES, _CLEARLY = 0.05, 2.0  # rad/s (RMS) of an axis that moves, and how many times as much as the next
_LARGEST = 1 << 26  # bytes of an answer
_AXES = ("x", "y", "z")
_OPEN = 'open "Gyroscope (rotation rate)" in phyphox'
_REACH = (
    'let telephone and computer be in the same network, switch on "Allow remote access" in the menu of an experiment in phyphox, and '
    f"write the address that it shows as capture.port (an iPhone's port is 80, others' {PORT})"
)


class Gone(OSError):
    """The telephone does not record on, or not the same."""


class _Mute(Exception):
    """No answer, or one that is none of phyphox."""


def known(settings: Mapping[str, Any]) -> dict[str, Any]:
    """What of the config's ``capture`` a telephone itself decides: format, unit, no time to settle, and patience with a network."""
    if settings["signal_unit"] not in ("V", UNIT):  # V is what stands there where nobody says anything
        problem = f"a telephone's gyroscope gives {UNIT} and capture.signal_unit is {settings['signal_unit']}"
        raise _error(problem, "leave signal_unit out")
    patient = max(float(settings["timeout_s"]), PATIENCE + 2 * _ANSWER)
    return {"format": "timed", "signal_unit": UNIT, "settle_s": 0.0, "timeout_s": patient}


class _Channel(NamedTuple):
    """Buffers of a telephone: of the time (s) and, by axis, of the angular rate (rad/s); the experiment's title."""

    clock: str
    rates: Mapping[str, str]
    title: str


class Telephone:
    """An experiment that runs on a telephone; see ``source``.

    ``what`` says what of it is recorded, ``events`` when (s since 1970) and how its network failed meanwhile.
    """

    def __init__(
        self, remote: "_Remote", channel: _Channel, axis: str, looked: "_Look", began: "_Began"
    ) -> None:
        self._remote, self._began = remote, began
        self._clock, self._rate = channel.clock, channel.rates[axis]
        self._ended = ""  # what was done on the telephone that ended it
        self.rate, self._last = looked.rate, looked.last
        self.name = f"{remote.name} ({channel.title})"
        self.what = f"{self._rate} of the telephone ({axis} of its gyroscope, {looked.why(axis)})"
        self.events: list[tuple[float, str]] = []
        self._mute: float | None = None  # since when, by this computer's clock that nobody sets

    def read(self) -> bytes:
        """The samples since the last, in the format ``timed``; b"" where there are none, or no answer for a while."""
        time.sleep(_POLL)
        if self._ended:
            raise Gone(self._ended)
        try:
            found, until = self._asked(), self._until()
            if until < math.inf:  # what came between the two questions
                found = self._asked()
        except _Mute as problem:
            self._mute = self._mute or time.monotonic()
            if time.monotonic() - self._mute > PATIENCE:
                raise Gone(f"no answer for {PATIENCE:g} s: {problem}") from problem
            return b""
        if self._mute is not None:
            lost = time.monotonic() - self._mute
            self.events.append(
                (time.time(), f"the telephone did not answer for {lost:.1f} s and kept its samples meanwhile")
            )
            self._mute = None
        times, values = found.between(self._last, until)
        self._last = float(times[-1]) if len(times) else self._last
        return Timed.encoded(times, values[:, 0])

    def _asked(self) -> "_Samples":
        return self._remote.samples(self._clock, [self._rate], self._last, self._began.session)

    def _until(self) -> float:
        """The time on its clock (s) up to which its samples are of this recording."""
        marks, begun = self._remote.marks(), self._began.marks
        if marks == begun:
            return math.inf
        if marks[: len(begun)] != begun:
            raise Gone("the data were cleared on the telephone")
        self._ended = "the recording was stopped on the telephone"
        return marks[len(begun)].at

    def close(self) -> None:
        """Stops the experiment; its data stay on the telephone."""
        with contextlib.suppress(_Mute):
            self._remote.control("stop")


class _Mark(NamedTuple):
    """A start or a pause of an experiment: which, when on its own clock (s), and when (s since 1970)."""

    event: str
    at: float
    when: float


class _Began(NamedTuple):
    """What tells a recording from others: the experiment that is open, and its starts and pauses so far."""

    session: str
    marks: Sequence[_Mark]


class _Samples(NamedTuple):
    """An answer: times (s), and values (sample, buffer; nan where there is none)."""

    times: np.ndarray
    values: np.ndarray

    def between(self, last: float, until: float) -> tuple[np.ndarray, np.ndarray]:
        """Times beyond ``last``, to ``until``, each later than those before it, with their values; without samples that lack a number."""
        whole = np.isfinite(self.values).all(axis=1) & (self.times <= until)
        times, values = self.times[whole], self.values[whole]
        latest = np.maximum.accumulate(np.concatenate([[last], times]))[:-1]
        return times[times > latest], values[times > latest]


class _Look(NamedTuple):
    """What a telephone sent before the recording: samples a second, its last time (s), and by axis how far it moved (RMS, rad/s)."""

    rate: float
    last: float
    moved: Mapping[str, float]
    asked: bool

    def why(self, axis: str) -> str:
        """Why this axis was taken."""
        return "as asked for" if self.asked else f"which moved most: {self.told()}"

    def told(self) -> str:
        """How far each axis moved, in words."""
        return ", ".join(f"{axis} {moved:.2g}" for axis, moved in self.moved.items()) + f" {UNIT} RMS"


class _Remote:
    """The remote interface of phyphox at an address."""

    def __init__(self, where: str) -> None:
        self.name = where
        self._base = "http://" + _address(where)
        # a proxy of the world outside knows no telephone in the room
        self._opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))

    def asked(self, path: str, **parameters: str) -> Any:
        """The JSON that it answers; _Mute where it does not."""
        query = f"?{urllib.parse.urlencode(parameters)}" if parameters else ""
        try:
            with self._opener.open(f"{self._base}/{path}{query}", timeout=_ANSWER) as answer:
                return json.loads(answer.read(_LARGEST))
        except urllib.error.HTTPError as problem:
            raise _Mute(f"it answers {problem.code} to /{path}") from problem
        except (OSError, http.client.HTTPException, ValueError, RecursionError) as problem:
            text = getattr(problem, "reason", None) or problem
            raise _Mute(str(text) or type(problem).__name__) from problem

    def control(self, command: str) -> bool:
        """True where it takes the command: start, stop or clear."""
        return _of(self.asked("control", cmd=command), "result", bool)

    def marks(self) -> list[_Mark]:
        """The starts and pauses of its experiment, since it was cleared."""
        found = self.asked("time")
        keys = ("event", "experimentTime", "systemTime")
        try:
            return [
                _Mark(str(event), float(at), float(when)) for event, at, when in map(itemgetter(*keys), found)
            ]
        except (TypeError, KeyError, ValueError) as problem:
            raise _Mute("an answer without starts and pauses") from problem

    def samples(
        self, clock: str, rates: Sequence[str], last: float | None, session: str | None = None
    ) -> _Samples:
        """What it holds of these buffers since a time (s; None for all); Gone where another session than this is open."""
        since, beside = ("full", "full") if last is None else (repr(last), f"{last!r}|{clock}")
        found = self.asked("get", **{clock: since, **dict.fromkeys(rates, beside)})
        buffers, status = _of(found, "buffer", dict), _of(found, "status", dict)
        if session not in (None, _of(status, "session", str)):
            raise Gone("another experiment was opened on the telephone")
        columns = [_numbers(_of(_of(buffers, name, dict), "buffer", list)) for name in (clock, *rates)]
        count = min(map(len, columns))
        times, *values = (one[:count] for one in columns)
        return _Samples(times, np.column_stack(values))

    def status(self, clock: str) -> dict[str, Any]:
        """Whether it records, and which experiment."""
        return _of(self.asked("get", **{clock: ""}), "status", dict)


def connect(settings: Mapping[str, Any]) -> Telephone:
    """The running Telephone of ``settings`` (the config's ``capture``); InputError where it cannot be used.

    What its experiment held is cleared. ``signal_column`` names the axis (x, y, z, or its buffer); without it, it is the one that moves most while
    the telephone is looked at for some 1.5 s.
    """
    remote = _Remote(settings["port"])
    channel = _channel(_reached(remote), remote.name)
    asked = _axis_of(settings.get("signal_column"), channel)
    try:
        remote.marks()  # before anything is cleared: whether it has them
        status = remote.status(channel.clock)
        _check_idle(status, remote.name)
        if not (remote.control("clear") and remote.control("start")):
            mend = "start it on the telephone once, and look what it says"
            raise _error(f"the experiment on {remote.name} does not start", mend)
        try:
            looked = _looked(remote, channel, [asked] if asked else list(channel.rates))
            axis = asked or _most_moved(looked)
            began = _Began(str(status.get("session")), remote.marks())
        except InputError:
            remote.control("stop")
            raise
    except _Mute as problem:
        mend = "keep phyphox open, with its screen on, and try again"
        raise _error(f"{remote.name} stopped answering ({problem})", mend) from problem
    return Telephone(remote, channel, axis, looked, began)


def _reached(remote: _Remote) -> Any:
    """What experiment is open on the telephone."""
    for left in reversed(range(_TRIES)):
        try:
            return remote.asked("config")
        except _Mute as problem:
            if not left:
                raise _error(f"no phyphox answers at {remote.name} ({problem})", _REACH) from problem
        time.sleep(_POLL)


def _check_idle(status: Mapping[str, Any], name: str) -> None:
    if status.get("measuring"):
        problem = f"{name} is recording already"
        raise _error(problem, "stop it there, and save what is to be kept: a capture clears it")
    if status.get("timedRun"):
        problem = f"{name} waits for a timed run"
        raise _error(problem, "switch the timed run off in phyphox: capture.duration_s tells how long")


def _looked(remote: _Remote, channel: _Channel, axes: Sequence[str]) -> _Look:
    """A look at the first samples of a recording that has begun."""
    begun, rates = time.monotonic(), [channel.rates[axis] for axis in axes]
    while True:
        time.sleep(_POLL)
        times, values = remote.samples(channel.clock, rates, None).between(-math.inf, math.inf)
        passed = time.monotonic() - begun
        if passed > _LOOK and len(times) >= _ENOUGH and times[-1] - times[0] > _LOOK / 2:
            break
        if passed > _LOOK + _STARTS:
            problem = f"its gyroscope gives {len(times)} samples in {passed:.0f} s"
            raise _error(problem, "look at the experiment on the telephone whether it shows any")
    moved = np.sqrt(np.mean((values - values.mean(axis=0)) ** 2, axis=0))
    rate = float((len(times) - 1) / (times[-1] - times[0]))
    usual = float(1 / np.median(np.diff(times)))
    # the mean but for gaps, which make it less than the usual one
    rate = rate if abs(rate / usual - 1) < 0.05 else usual
    return _Look(rate, float(times[-1]), dict(zip(axes, map(float, moved), strict=True)), len(axes) == 1)


def _most_moved(looked: _Look) -> str:
    """The axis that moved most, where one did clearly; InputError where none did."""
    axis = max(looked.moved, key=lambda one: looked.moved[one])
    others = [moved for one, moved in looked.moved.items() if one != axis]
    if looked.moved[axis] < _MOVES or any(looked.moved[axis] < _CLEARLY * moved for moved in others):
        raise InputError(
            "capture.signal_column",
            f"the axis that swings is not stated, and no axis moves clearly most: {looked.told()}",
            f"one of {', '.join(looked.moved)}, or an axis that moves {_CLEARLY:g} times as much as the others",
            "let it swing while the capture connects, or name the axis that the telephone turns about (signal_column: y)",
        )
    return axis


def _channel(config: Any, name: str) -> _Channel:
    """The buffers of the gyroscope; InputError for an experiment without any that it exports."""
    title = config.get("title") if isinstance(config, dict) else None
    inputs = config.get("inputs") if isinstance(config, dict) else None
    if not isinstance(inputs, list):
        problem = f"what answers at {name} is not phyphox, or an old one"
        raise _error(problem, f"update phyphox (1.1.8 or later); {_REACH}")
    exported = {one.get("buffer") for part in config.get("export") or () for one in _dicts(part, "sources")}
    for one in inputs:
        if not isinstance(one, dict) or one.get("source") != "gyroscope":
            continue
        buffers = {key: str(buffer) for output in _dicts(one, "outputs") for key, buffer in output.items()}
        rates = {axis: buffers[axis] for axis in _AXES if buffers.get(axis) in exported}
        if rates and buffers.get("t") in exported:
            return _Channel(buffers["t"], rates, str(title or "phyphox"))
    raise _error(f"the experiment {str(title)!r} on {name} exports no gyroscope with its time", _OPEN)


def _dicts(found: Any, key: str) -> list[dict[str, Any]]:
    """The mappings in a list of a mapping; none where it is otherwise."""
    inside = found.get(key) if isinstance(found, dict) else None
    return [one for one in inside if isinstance(one, dict)] if isinstance(inside, list) else []


def _axis_of(asked: str | None, channel: _Channel) -> str | None:
    """The axis that is asked for by its letter or its buffer; None where none is."""
    if asked is None:
        return None
    for axis, buffer in channel.rates.items():
        if asked in (axis, buffer):
            return axis
    names = ", ".join(f"{axis} ({buffer})" for axis, buffer in channel.rates.items())
    problem = f"the telephone's gyroscope has no {asked!r}"
    raise InputError("capture.signal_column", problem, names, "name one of them")


def _address(where: str) -> str:
    """HOST:PORT of ``phyphox://HOST[:PORT]``."""
    try:
        parts = urllib.parse.urlsplit(where)
        host, port = parts.hostname, parts.port or PORT
    except ValueError:
        host, port, parts = None, PORT, urllib.parse.urlsplit("")
    if not host or parts.path.strip("/") or parts.query or parts.username:
        problem = f"{where} is no address of a telephone"
        raise _error(problem, "write phyphox://192.168.0.12:8080, as phyphox shows it")
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"


def _of(found: Any, key: str, kind: type) -> Any:
    """A part of an answer; _Mute where it is not there."""
    part = found.get(key) if isinstance(found, dict) else None
    if not isinstance(part, kind):
        raise _Mute(f"an answer without {key}")
    return part


def _numbers(found: Sequence[Any]) -> np.ndarray:
    """The values of a buffer, nan for what is no number."""
    numbers = (
        one if isinstance(one, int | float) and not isinstance(one, bool) else math.nan for one in found
    )
    return np.array(list(map(float, numbers)), dtype=float)


def _error(problem: str, mend: str) -> InputError:
    expected = "phyphox://HOST:PORT of a telephone on which phyphox allows remote access"
    return InputError("capture.port", problem, expected, mend)
