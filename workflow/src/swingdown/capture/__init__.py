"""Recording from hardware: wire formats, the device's clock, losses, and how a recording ends.

``source`` opens what samples come from (``port``: a serial line; ``labjack``; ``telephone``), ``listener`` reads it, ``formats`` turns bytes into
samples, ``order`` puts them on the device's clock and finds what is missing, ``trigger`` finds the release, ``recorder`` tells how
it ended, ``clocks`` and ``verdict`` what speaks against it. ``journal`` keeps every byte on disk as it arrives, ``recording`` ties
these together for one recording and ``session`` for several (``takes``, ``job``: what is asked for; ``guide``: prompts), ``take``
and ``sheets`` write it; ``monitor`` and ``live`` show it. Only here is a serial port opened.
"""
