"""Estimates from one frozen frame where the light is: rooms with one direction of imports (docs/contributing.md).

May import `core` and `errors`; which room may import which is stated in each one's own `__init__`.
"""
