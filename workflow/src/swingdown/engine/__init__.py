"""The compiled engine: catalogue formulas become C, are compiled once with the integrator and kept by content.

``trajectory`` is what others use. It goes through ``interface`` (the C functions) and ``build``, which puts together what is
written by hand in ``c`` (``c/engine.c`` tells the order to read it in) and what ``generate`` writes from the catalogue, has it
compiled by ``compiler`` and kept by ``cache``.
"""
