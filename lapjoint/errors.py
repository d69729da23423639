"""The one kind of error that a user's input may raise."""


class InputError(ValueError):
    """Bad input: a message that names the field, the value and what is allowed.

    The command line prints it without a traceback and exits with status 2.
    """


class SolverError(RuntimeError):
    """The solver could not do what was asked; the message says where it stopped and why."""
