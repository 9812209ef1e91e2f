"""Outlines of bodies and shadows in the picture at full resolution: aligned with steps of light, blurred by penumbrae.

May import `core`, `pixels`, `shape` and `outline_fit`.
"""
