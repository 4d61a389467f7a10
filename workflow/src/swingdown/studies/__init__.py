"""The paper's two studies: simulated swings with noise and measured ones, their norms, comparison and tables."""
