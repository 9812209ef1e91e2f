"""Measures accuracy, speed, and the trade between them."""
