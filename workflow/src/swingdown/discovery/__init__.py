"""Where a model and the recordings disagree, which effect is missing, and whether swings it never saw confirm it.

Data flow: ``campaign`` (swings, split, noise) -> ``locate`` (where the residual lies) -> ``candidates`` and ``name``
(which effects explain it) -> ``confirm`` (held-out swings) -> ``rounds`` (again) -> ``verdict``.
"""
