"""References that several entries share."""

PAPER = "Petrushenko and Khasawneh, IMECE 2017"
SQUIRE = "Squire, Am. J. Phys. 54, 984 (1986)"
MECHANICS = "Nayfeh and Mook, Nonlinear Oscillations (1979)"
METROLOGY = "JCGM 200:2012 (International vocabulary of metrology)"
