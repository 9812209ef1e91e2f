"""The errors that a user can mend, and the exit statuses that commands end with."""

from enum import IntEnum


class ExitStatus(IntEnum):
    """What a command ends with; of several files the worst counts, in the order 1, 2, 3, 4, 0 (docs/contract.md)."""

    ANSWERED = 0
    FAULT = 1  # of the program itself, as the interpreter has it
    WRONG_USE = 2
    NO_MARKER = 3
    NO_DIRECTIONAL_LIGHT = 4
    INTERRUPTED = 130  # by Ctrl-C, as shells have it


class ModelWarning(UserWarning):
    """A model is drawn differently from what its file says; the text says what differs."""


class UserError(Exception):
    """Something that the user can put right; a command ends with it as one line on stderr and exit status 2.

    `message` says what is wrong, `remedy` what to do about it.
    """

    def __init__(self, message: str, remedy: str) -> None:
        super().__init__(f"{message}: {remedy}")
        self.message = message
        self.remedy = remedy

    def __reduce__(self) -> tuple[type["UserError"], tuple[str, str]]:
        return type(self), (self.message, self.remedy)
