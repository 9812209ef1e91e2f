"""The fall of light over the ground, which reveals a lamp's nearness; and lamps lower than what they light."""
