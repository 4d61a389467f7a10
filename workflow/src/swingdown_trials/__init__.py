"""Trials of discovery: campaigns in which the truth is known and hidden, and the score of the verdicts on them.

``second_pendulum`` has equations and an integrator of its own, and ``trial`` writes what it makes as sample sheet and CSV
files, with the truth in another place; ``score`` alone reads both.
"""
