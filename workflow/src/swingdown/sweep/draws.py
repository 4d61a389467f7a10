"""What a cell and a draw are known by: keys that stand for settings, and the stream of random numbers of each draw."""

import hashlib
import json

import numpy as np

# Settings that a swing's noise does not depend on: with other models fitted it stays the same swing.
_OF_THE_FIT = {"simulation.fitted", "simulation.start", "discovery.base", "discovery.rounds", "seed"}
# Keys that came later, with the value that stands for what was computed before them: there they change no key.
LATER = {"detection.noise": "additive", "detection.snr": None}


def cell_key(computes, settings):
    """32 hexadecimal digits that stand for all settings of a cell: what was computed under them stays valid."""
    return _digest([computes, dict(sorted(_told(settings)))])


def noise_key(settings):
    """32 hexadecimal digits that stand for a swing: the settings less the seed and what is fitted to it."""
    return _digest({key: value for key, value in sorted(_told(settings)) if key not in _OF_THE_FIT})


def value_of(settings, name):
    """The value of a model's parameter in a cell: the key ``simulation.NAME``, else ``parameters.NAME``."""
    key = f"simulation.{name}"
    return settings[key] if key in settings else settings[f"parameters.{name}"]


def stream(settings, key, realization):
    """The numpy Generator of one draw: of the seed, the swing (``noise_key``) and the draw's index alone.

    So a draw is the same in whatever chunk, order, process or machine it is made, and whatever else the sweep holds.
    """
    words = [int(key[k : k + 8], 16) for k in range(0, 32, 8)]
    return np.random.default_rng(np.random.SeedSequence(settings["seed"], spawn_key=(*words, realization)))


def _told(settings):
    return ((key, value) for key, value in settings.items() if key not in LATER or value != LATER[key])


def _digest(content):
    return hashlib.sha256(json.dumps(content, separators=(",", ":")).encode()).hexdigest()[:32]
