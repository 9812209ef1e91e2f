"""The lit ground, what of the picture it does not explain, and by how much a shadow changes its colours.

May import `core` and `pixels`.
"""
