"""Statistics of long motions: the question, how each realisation is summarised, and the table."""
