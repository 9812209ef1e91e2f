"""The marker and its sheet, painted over by the ground around them."""
