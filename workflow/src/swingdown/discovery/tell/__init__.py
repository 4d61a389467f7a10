"""Values, verdict, sentence and files."""
