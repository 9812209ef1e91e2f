"""Outlines of masks, as what a body is fitted to."""
