"""The estimators by name: what takes a tracked frame and answers with a light or a reason.

May import `core`, `errors`, `pixels`, `ground`, `outline_fit`, `labels`, `explanation` and `paper`.
"""
