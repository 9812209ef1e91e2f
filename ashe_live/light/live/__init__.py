"""Estimates while the program runs: in a process of their own, several of them made one.

May import `core`, `estimators` and `process`.
"""
