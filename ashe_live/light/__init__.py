"""Estimates from one frozen frame where the light is."""
