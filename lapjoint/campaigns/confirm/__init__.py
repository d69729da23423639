"""The bifurcations of branches looked for by another solver: the question, how it is answered, and the table."""
