"""Published cases with known answers, computed by the code that fits swings and propagates uncertainty."""
