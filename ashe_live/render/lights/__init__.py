"""Light as shaders want it: suns and lamps, their shadow maps, and the surroundings."""
