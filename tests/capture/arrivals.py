"""Boards whose clocks are at fault, and what a host makes of the arrivals: simulated, without real time."""

import numpy as np

TOLD = 100  # samples a second that the config tells
SECONDS = 20


def steady(rate):
    return lambda t: rate + 0 * t


def halves(first, second, seconds=SECONDS):
    return lambda t: np.where(t < seconds / 2, first, second)


def wobble(part, period):
    return lambda t: TOLD * (1 + part * np.sin(2 * np.pi * t / period))


def briefly(rate, since, until):
    return lambda t: np.where((t >= since) & (t < until), rate, TOLD)


def made_up(t):
    """Faster after each stall of 0.3 s, until the delay is made up."""
    return np.where((t > 5) & ((t - 5) % 5 < 3), 110, 100)


def sent(rate=None, stalls=(), seconds=SECONDS):
    """The times (s) at which a board takes its samples: as many as the config expects in ``seconds``.

    ``rate(t)`` is in samples a second; each of ``stalls`` is (when, how long).
    """
    fine = np.linspace(0, 2 * seconds + 1, 100_001)
    rates = (rate or steady(TOLD))(fine)
    count = np.concatenate([[0], np.cumsum((rates[1:] + rates[:-1]) / 2 * np.diff(fine))])
    times = np.interp(np.arange(seconds * TOLD), count, fine)
    for at, long in stalls:
        times = times + long * (times >= at)
    return times


def scattered(times, random, size=0.001):
    """Arrivals that are late by a millisecond, more or less."""
    return np.maximum.accumulate(times + 0.005 + size * random.standard_normal(len(times)))


def bursts(times, random, every):
    """Arrivals in bursts ``every`` so many seconds, each late by half a millisecond on average."""
    phase = random.uniform(0, every)
    number = np.ceil((times - phase) / every).astype(int)
    late = random.exponential(0.0005, number.max() + 2)
    return np.maximum.accumulate(phase + number * every + late[number])


SCATTER = {
    "1 ms": scattered,
    "bursts of 16 ms": lambda times, random: bursts(times, random, 0.016),
    "bursts of 62 ms": lambda times, random: bursts(times, random, 0.062),
}
WANDERS = {
    "110 then 90": {"rate": halves(110, 90)},
    "105 then 95": {"rate": halves(105, 95)},
    "103 then 97": {"rate": halves(103, 97)},
    "100 then 98": {"rate": halves(100, 98)},
    "101 then 99": {"rate": halves(101, 99)},
    "thirds at 103, 97, 100": {
        "rate": lambda t: np.select([t < SECONDS / 3, t < 2 * SECONDS / 3], [103, 97], 100)
    },
    "104 falling to 96": {"rate": lambda t: 104 - 8 * t / SECONDS},
    "101 falling to 99": {"rate": lambda t: 101 - 2 * t / SECONDS},
    "wobble of 10 % with 10 s": {"rate": wobble(0.1, 10)},
    "wobble of 5 % with 20 s": {"rate": wobble(0.05, 20)},
}
SMALL = {
    "0.3 % over 3 s in the middle": {"rate": briefly(100.3, 8, 11)},
    "0.3 % over the first 3 s": {"rate": briefly(100.3, 0, 3)},
    "0.3 % over the last 3 s": {"rate": briefly(99.7, 17, 30)},
}
STALLS = {
    "0.2 s, 0.3 s after the beginning": [(0.3, 0.2)],
    "0.45 s, 0.9 s after the beginning": [(0.9, 0.45)],
    "0.05 s, 0.1 s after the beginning": [(0.1, 0.05)],
    "0.12 s in the middle": [(7.3, 0.12)],
    "0.041 s in the middle": [(12.1, 0.041)],
    "0.45 s, 0.9 s before the end": [(19.1, 0.45)],
    "0.2 s, 0.3 s before the end": [(19.7, 0.2)],
    "0.041 s, 0.2 s before the end": [(19.8, 0.041)],
}
