"""Fits of a family of models, each started from the optima of the models it contains."""


def fit_nested(labels, fit):
    """A dict of fits by model label, in the order of ``labels``.

    ``fit(label, guess=fits or None)`` fits one model. Smaller models go first, and a larger one is started from every
    optimum of its sub-models besides its own starts: its sum of squares cannot then end above theirs, which the paper's
    Table 3 violates (κv,q,c .13249 against κq,c .13102).
    """
    fits = {}
    for label in sorted(labels, key=_size):
        inside = [fits[other] for other in fits if contains(label, other)]
        fits[label] = fit(label, guess=inside or None)
    return {label: fits[label] for label in labels}


def contains(label, other):
    """True if the model ``label`` has every effect of the model ``other`` and at least one more."""
    return set(other.split("+")) < set(label.split("+"))


def _size(label):
    return label.count("+")
