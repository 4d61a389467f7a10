"""The paper's figures, one function each: they read datasets, compute nothing, and return a matplotlib Figure.

``FIGURES`` goes by the figures' names; the names of a function's arguments say which datasets it wants. Figures 1 and 6 take none:
they lie drawn in ``workflow/report``. ``save`` writes a figure as SVG and PNG.
"""

from .calibration import fig08, fig09
from .experiment import fig10, fig11, fig12, fig13, fig14, fig15
from .schematics import fig07
from .simulation import fig02, fig03, fig04, fig05
from .style import absent, save

FIGURES = {
    function.__name__: function
    for function in (
        fig02, fig03, fig04, fig05, fig07, fig08, fig09, fig10, fig11, fig12, fig13, fig14, fig15,
    )
}  # fmt: skip

__all__ = ["FIGURES", "absent", "save", *FIGURES]
