"""Draws the scene with OpenGL; the only place that knows moderngl."""
