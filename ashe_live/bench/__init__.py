"""Benchmarks of accuracy, speed, and the trade-off between them: a folder for each, and shared modules beside them.

May import every package but `commands` and `cli`.
"""
