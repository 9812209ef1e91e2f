"""Outlines of bodies aligned with the steps of light in the picture at full resolution.

May import `core`, `pixels`, `shape` and `outline_fit`.
"""
