"""Requests for estimates of the light: when they are made, refined and followed, and how the light eases to them."""
