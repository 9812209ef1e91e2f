"""Live desktop AR whose virtual objects are lit, and cast their shadows, as the real ones do."""

__version__ = "0.1.0"
