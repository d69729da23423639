"""The cases of the suite: each asks one question, and answers it by checks, tables and figures."""
