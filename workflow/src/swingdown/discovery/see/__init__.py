"""Where a model and the swings disagree: to first order, beside a discrepancy, and what of it has which shape."""
