"""The estimators by name: what takes a tracked frame and answers with a light or a reason.

May import `core`, `errors` and every other room of `light` but `live`.
"""
