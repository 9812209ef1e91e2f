"""The lit ground, the parts of the picture that it does not explain, and the shift that a shadow gives its colours.

May import `core` and `pixels`.
"""
