"""The command line's flags and settings, and what they stand for."""
