"""Frames on their way from a source to the screen, on threads of their own."""
