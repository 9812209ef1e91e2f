"""Estimates while the program runs: the views that are kept for them, the process that makes them, the answer held.

May import `core`, `errors`, `pixels`, `estimators`, `views` and `process`.
"""
