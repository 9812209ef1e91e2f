"""The AShE paper's method as published, the baseline for the others.

May import `core`.
"""
