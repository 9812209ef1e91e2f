"""Lights from the shadows of a body whose shape and place are known, as those of the paper cube: only they are fitted.

May import `core`, `pixels` and `shape`.
"""
