"""The light of the sides of a body whose shape is known: which are seen, what lights them, and what they send on."""
