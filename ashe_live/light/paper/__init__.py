"""The AShE paper's method as published, with which the others are compared.

May import `core`.
"""
