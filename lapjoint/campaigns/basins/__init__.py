"""Where many starts end: what is asked, how each chunk of starts is solved, and the table of motions."""
