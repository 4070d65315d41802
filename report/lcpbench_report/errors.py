"""The one exception that ends as a line for the user instead of a traceback."""


def printable(text: str) -> str:
    """For one line of a terminal: names and files may hold any characters."""
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


class ReportError(Exception):
    """A file that is missing or is not what the schema says.

    @param file      name of the file, as in benchmarks/RESULTS.md
    @param problem   what is wrong, with the offending value
    @param expected  what would have been right
    """

    def __init__(self, file: str, problem: str, expected: str):
        super().__init__(" ".join(f"{file}: {problem}; expected {expected}".split()))
