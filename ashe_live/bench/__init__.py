"""Measures accuracy, speed, and the trade between them: a folder for each bench, beside it what they share.

May import every package but `commands` and `cli`.
"""
