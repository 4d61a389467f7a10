"""Pendulum swings: calibration, trajectories, fits of damping models, and what the fits leave unexplained.

Plain functions on arrays and datasets; nothing here knows of the workflow that calls it.
"""
