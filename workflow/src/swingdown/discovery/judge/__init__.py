"""How probable each structure is, and what may be said of an effect."""
