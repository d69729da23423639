"""Statistics of long motions: what is asked, how each realisation is summarised, and the table."""
