"""The sections of the report, a file each: a function of the ``Material`` that returns a ``page.Section``."""

# Campaigns that are shown at length, some 0.7 MB each; of more there is one table and one picture.
FEW = 2
