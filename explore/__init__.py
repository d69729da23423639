"""The page of ``lapjoint explore``: a joint as a form, and beside it what both solvers answer."""
