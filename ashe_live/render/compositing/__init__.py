"""How the layers of what is drawn become part of the video: as the camera that filmed it would show them."""
