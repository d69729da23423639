"""The errors that are raised on purpose; each has a message that a user can act on."""


class InputError(ValueError):
    """Bad input: a message that names the field, the value and what is allowed.

    The command line prints it without a traceback and exits with status 2.
    """


class SolverError(RuntimeError):
    """A solver could not do as asked; the message says where it stopped and why."""


class OutputError(RuntimeError):
    """A file or stream could not be written; the message says why, and what is kept.

    The command line prints it without a traceback and exits with status 3.
    """


class DamageWarning(UserWarning):
    """A part of a file is damaged; the message says which part, and how it is treated."""


class ExcitationWarning(UserWarning):
    """An excitation is hardly the intended one, or cannot drive the joint as it should; the message says why."""


class RecordWarning(ExcitationWarning):
    """A record is hardly as it was measured, or cannot drive the joint as it should; the message says why."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C in work that can be resumed; the message says what is kept."""
