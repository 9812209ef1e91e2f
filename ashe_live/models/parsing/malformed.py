"""The error of everything that reads a model file."""


class MalformedError(ValueError):
    """A file is not what its format asks for; the message says where, in the format's words."""
