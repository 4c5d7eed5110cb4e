"""What ends a comparison."""


class Failure(Exception):
    """What went wrong, where, and what to do about it."""
