"""The report: one HTML file that holds everything it shows. ``page`` is its form, ``contents`` what it says."""
