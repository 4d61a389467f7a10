"""The compiled engine: catalogue formulas become C, are compiled once with the integrator and kept by content."""
