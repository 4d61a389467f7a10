"""From a file to an angle with bounds: sample sheet, recordings, their quality and noise, apparatus, lines, uncertainty."""
