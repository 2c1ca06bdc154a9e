"""The exceptions of segue."""

from __future__ import annotations


class SegueError(Exception):
    """The base of what segue raises beside Python's own exceptions."""


class ReadError(SegueError, ValueError):
    """A file that cannot be read as motion. Its text says what to do.

    Attributes
    ----------
    file : str
        The file's name.
    line, column : int
        The place of the fault, counted from 1; 1, 1 for the file as a whole.
    found, expected : str or None
        The text at that place, and the text that was expected there.
    hint : str or None
        Advice, where there is better advice than ``expected``.
    """

    def __init__(
        self,
        text: str,
        file: str = "",
        line: int = 1,
        column: int = 1,
        found: str | None = None,
        expected: str | None = None,
        hint: str | None = None,
    ) -> None:
        # All arguments, so that the exception travels between processes.
        super().__init__(text, file, line, column, found, expected, hint)
        self.file = file
        self.line = line
        self.column = column
        self.found = found
        self.expected = expected
        self.hint = hint

    def __str__(self) -> str:
        return str(self.args[0])


class WriteError(SegueError, ValueError):
    """A motion that a format cannot hold."""


class LabError(SegueError, ValueError):
    """Clips or values from which a lab makes no result. Its text says what to do."""


class ReadErrors(ExceptionGroup, SegueError):
    """The files of a list that could not be read, as an exception group.

    Attributes
    ----------
    results : list of Clip or Exception
        What became of every file, in the order of the list: nothing that was read is lost.
    """

    results: list

    def __new__(cls, text: str, exceptions: list, results: list | None = None) -> ReadErrors:
        made = super().__new__(cls, text, exceptions)
        made.results = [] if results is None else results
        return made

    def __init__(self, text: str, exceptions: list, results: list | None = None) -> None:
        super().__init__(text, exceptions)

    def derive(self, excs):  # noqa: D102
        return ReadErrors(self.message, excs, self.results)
