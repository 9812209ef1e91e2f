// Copies a picture that is already encoded for the display.
#version 330 core

uniform sampler2D picture;

in vec2 uv;
out vec4 encoded;

void main() {
    encoded = texture(picture, uv);
}
