"""What the recorder's clock makes of time."""

from ..effect import Effect, Parameter
from .sources import METROLOGY

CLOCK = (
    Effect(
        "clock_drift",
        "t + d_c*t**2/duration",
        (
            Parameter(
                "clock_drift", "d_c", "1", -0.2, 0.2, "relative gain of the clock over the longest record", 0.002, largest=0.05
            ),
        ),
        "The recorder's clock runs faster and faster, or slower and slower.",
        METROLOGY,
        acts_on="clock",
    ),
)  # fmt: skip
