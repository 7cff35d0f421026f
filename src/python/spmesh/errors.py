"""What a reader refuses."""


class SpmeshError(ValueError):
    """A stream that is refused. `place` says where: the header, or the block and its first byte."""

    def __init__(self, message: str, place: str = ""):
        super().__init__(f"{place}: {message}" if place else message)
        self.message, self.place = message, place


class MalformedError(SpmeshError):
    """The stream breaks a rule of the format, or is cut off (exit code 3 of the programs)."""


class TooNewError(SpmeshError):
    """The stream needs what this version does not know (exit code 6 of the programs)."""


def require(holds, message: str) -> None:
    if not holds:
        raise MalformedError(message)


def needs(part: str) -> None:
    raise TooNewError(f"the stream needs {part}, which this package does not know: a newer spmesh made it")
