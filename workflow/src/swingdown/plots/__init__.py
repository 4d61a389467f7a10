"""The paper's figures, one function each: they read datasets, compute nothing, and return a matplotlib Figure.

``FIGURES`` goes by the figures' names; the names of a function's arguments say which datasets it wants. Figures 1 and 6 take none:
they lie drawn in ``workflow/report``. ``save`` writes a figure as SVG and PNG.
"""

from functools import partial

from .calibration import fig08, fig09
from .experiment import fig15, fit_of, fit_of_pair
from .schematics import fig07
from .simulation import fig02, norms_of
from .style import absent, save

FIGURES = {
    "fig02": fig02,
    "fig03": partial(norms_of, "viscous"),
    "fig04": partial(norms_of, "quadratic_drag"),
    "fig05": partial(norms_of, "load_coulomb"),
    "fig07": fig07,
    "fig08": fig08,
    "fig09": fig09,
    "fig10": partial(fit_of, "viscous"),
    "fig11": partial(fit_of, "quadratic_drag"),
    "fig12": partial(fit_of, "load_coulomb"),
    "fig13": partial(fit_of_pair, 0),
    "fig14": partial(fit_of_pair, 1),
    "fig15": fig15,
}

__all__ = ["FIGURES", "absent", "save"]
