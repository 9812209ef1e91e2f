"""Properties of the video's camera, measured in its pictures: exposure, blur, sharpening, colour, noise."""
