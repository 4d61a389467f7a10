"""A film of a pendulum as a recording."""
