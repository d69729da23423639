"""The motions in which many starts end: the plan, how each chunk of starts is solved, and the table of motions."""
