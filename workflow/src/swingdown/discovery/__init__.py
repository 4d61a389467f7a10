"""Where a model and the recordings disagree, which effect is missing, and whether swings it never saw confirm it.

Data flow: ``campaign`` (swings, split, noise) -> ``ranking`` (``candidates`` and ``pairs``: what could be added, and the fits) ->
``discrepancy`` (what each fit lacks, and its evidence) -> ``structures`` (the probability of each) -> ``search`` (the algorithm) ->
``judge`` (the numbers of ``guard``) -> ``rounds`` (what was seen on the way) -> ``verdict`` and ``sentence``.
"""
