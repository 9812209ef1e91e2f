// Where the real object is in the picture, whatever is in front of it.
#version 330 core

out float silhouette;

void main() {
    silhouette = 1.0;
}
