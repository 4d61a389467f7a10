"""Sweeps: the same question asked in every cell of a table of settings, many times each, in jobs that any machine may take.

``table`` reads axes and cells from the config, ``chunks`` deals the work out in jobs, ``identification`` and ``detection``
compute a cell, ``combine`` makes one dataset of all jobs, ``summary`` tells its probabilities, ``cost`` what it will take.
"""
