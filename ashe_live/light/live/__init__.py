"""Estimates while the program runs: made in a process of their own, and consecutive ones fused.

May import `core`, `estimators` and `process`.
"""
