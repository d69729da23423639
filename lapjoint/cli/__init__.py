"""The command line: commands, their common options, and the printing of answers."""
