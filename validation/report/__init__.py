"""The report: one page for people, and its tables and records as files for programs."""
