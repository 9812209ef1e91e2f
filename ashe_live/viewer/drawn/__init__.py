"""Overlays other than text: the time bar, and the inset with the estimate."""
