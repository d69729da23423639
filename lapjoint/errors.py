"""The errors that are raised on purpose; each has a message that a user can act on."""


class InputError(ValueError):
    """Bad input: a message that names the field, the value and what is allowed.

    The command line prints it without a traceback and exits with status 2.
    """


class SolverError(RuntimeError):
    """The solver could not do what was asked; the message says where it stopped and why."""


class OutputError(RuntimeError):
    """What was asked for could not be written, for whatever reason; the message says why, and what is kept.

    The command line prints it without a traceback and exits with status 3.
    """


class DamageWarning(UserWarning):
    """A part of a file is damaged; the message says which, and what is done about it."""


class ExcitationWarning(UserWarning):
    """An excitation can hardly be what was meant, or cannot drive what it should; the message says why."""


class RecordWarning(ExcitationWarning):
    """A record can hardly be what was measured, or cannot drive what it should; the message says why."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C in work that can be resumed; the message says what is kept."""
