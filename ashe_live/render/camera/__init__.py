"""What the video's camera does to a scene, measured in its pictures: exposure, blur, sharpening, colour, noise."""
