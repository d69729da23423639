"""Would the judge notice?  Faults of the kinds that real programs have, put in one at a time.

`fault` says what a fault is, `syntax` finds its place in the source, and `catalogue` lists all faults.  `changed_tree`
copies the packages and changes one module of the copy.  `trial` runs the cases on a copy until one disagrees, and
`running` runs many trials.  `table` tells what caught each fault, and `record` keeps the table for the documents.
`mutants` tries changes drawn at random in place of chosen faults.

A fault names no case that is to catch it: all faults go through the same cases in the same order, cheapest first.
"""
