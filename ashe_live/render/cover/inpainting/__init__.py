"""Fills a hole in a picture of the ground from the ground around it."""
