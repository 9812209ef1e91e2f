"""Draws specifications: what there may be, and where it stands."""
