"""The order of the compiled table of effects, which both the generator and its callers go by."""


def entries(catalogue, gravity):
    """The (effect, form) of each row: the gravities, then each effect in each form it has."""
    rows = [(effect, "consistent") for effect in gravity]
    for effect in catalogue:
        rows.append((effect, "consistent"))
        if effect.printed:
            rows.append((effect, "printed"))
    return rows
