"""Where a model and the recordings disagree, which effect is missing, and whether swings it never saw confirm it.

Rooms, each of which knows those before it: ``data`` (swings, split, noise) -> ``see`` (what a fit lacks: its discrepancy) -> ``move`` (what
could be added, and the fits) -> ``judge`` (the probability of each structure, and the numbers of ``criterion``) -> ``next`` (the swing to make
next) -> ``tell`` (values, verdict, sentence, files). ``search`` is the algorithm, ``rounds`` what was seen on its way, ``change`` what
follows where one thing was changed between recordings.
"""
