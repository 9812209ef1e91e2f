"""Clips that are read: their pictures, and the way to any of them."""
