"""The sections of the report, a file each: a function of the ``Material`` that returns a ``page.Section``."""
