"""A light's distance: whether it is a lamp near by, and where, from borders, other objects and the light's fall.

May import `core`, `pixels`, `ground`, `shape`, `explanation` and `views`.
"""
