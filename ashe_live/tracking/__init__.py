"""Finds the printed marker in a frame and where it stands in front of the camera."""
