"""What a pendulum is made of: effects, their catalogue, formulas, and models that have some of them."""
