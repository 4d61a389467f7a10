"""The sections of the report, a file each: a function of the ``Material`` that returns a ``page.Section``."""

FEW = 3  # campaigns that are shown at length; of more there is one table and one picture
