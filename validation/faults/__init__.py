"""Would the judge notice?  Faults of the kinds that real programs have, put in one at a time while the judge runs.

`fault` says what a fault is, `catalogue` lists them, one file for each place.  `changed_tree` makes a copy of the
packages with one fault in it, `trial` runs the cases on that copy, in a process of its own, until something disagrees,
and `running` does so for many faults.  `table` tells what caught each, and `record` keeps that for the documents.
`mutants` draws changes at random from the source, in place of chosen ones.

A fault names no case by which it is to be caught: all go through the same cases in the same order, cheapest first.
"""
