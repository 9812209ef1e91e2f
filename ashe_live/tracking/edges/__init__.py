"""Borders and corners of black squares in a picture, to a fraction of a pixel."""
