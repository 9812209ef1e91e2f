"""Calibration of a camera by a board."""
