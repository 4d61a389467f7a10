"""From a swing to a model's values: first guesses, least squares, the paper's Nelder-Mead, errors that know the noise."""
