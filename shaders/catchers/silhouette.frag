// Where the real object is in the picture, whatever is in front of it. Several draws, each moved by up to a pixel, add up.
#version 330 core

uniform vec2 adds;

out vec2 silhouette;  // 1 on the object; and the mean of the pixel and its four neighbours

void main() {
    silhouette = adds;
}
