"""Ambient occlusion by a model: of the ground around it, and of its own surface."""
