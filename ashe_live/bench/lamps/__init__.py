"""What the constants of lamps rest on, measured on pictures of lamps whose places are known."""
