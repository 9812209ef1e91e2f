"""How the light falls off over the ground, by which a lamp's nearness is told, and lamps lower than what they light."""
