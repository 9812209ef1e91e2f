"""Keys, mouse and menu: the requests that they make, and their effect on light and model."""
