"""What surfaces reflect: the share of the light, and maps of the ground and the sky for what is polished."""
