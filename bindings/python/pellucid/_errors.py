"""The exception of every failed call."""
from __future__ import annotations


class PellucidError(RuntimeError):
    """A call that the library refused or could not finish: what was wrong, where, and what would be right.

    Attributes
    ----------
    code : ErrorCode
        What kind of failure it was.
    """

    def __init__(self, code: int, message: str) -> None:
        super().__init__(message)
        from ._types import ErrorCode

        self.code = ErrorCode(code)

    def __reduce__(self) -> tuple[type[PellucidError], tuple[int, str]]:
        return PellucidError, (int(self.code), str(self))
