"""What may be opened, and how files are written: the only ways to a person's files, and to the fonts of the system.

Imports errors only; every other room may import it.
"""
