"""The command line: its commands, what they share, and how answers are printed."""
