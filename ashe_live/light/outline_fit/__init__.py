"""Fits bodies and lights to the outlines of an object and of its shadows.

May import `core` and `shape`.
"""
