"""Values and conventions that every other part shares: NumPy and pyrr only."""
