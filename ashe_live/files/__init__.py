"""What may be opened, and how files are written: the only ways to a person's files.

Imports errors only; every other room may import it.
"""
