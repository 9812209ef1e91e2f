"""What the search for a second light rests on, measured on pictures whose lights are known."""
