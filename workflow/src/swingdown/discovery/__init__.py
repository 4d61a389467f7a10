"""Where a model and the recordings disagree, which effect is missing, and whether swings it never saw confirm it.

Data flow: ``campaign`` (swings, split, noise) -> ``locate`` (where the residual lies) -> ``candidates``, ``pairs`` and ``ranking``
(which effects explain it) -> ``confirm`` (held-out swings) -> ``rounds`` (one move) -> ``search`` (again, and other ways) ->
``folds`` and ``established`` (what may be asserted although something remains) -> ``verdict``.
"""
