"""Do the two solvers agree, and is the paper right?  The judge, the witnesses, the cases, and the report."""
