"""Focal lengths from what markers look like."""
