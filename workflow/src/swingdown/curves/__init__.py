"""What a recording shows against the amplitude: period, loss, damping and torques, from a model and free of it; and the laws of damping."""
