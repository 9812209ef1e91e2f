"""Searches with a body at hand for what labels alone do not show: its shadow, a second light's, or where it stands."""
