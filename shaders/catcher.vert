// The part of the marker plane that the model may darken.
#version 330 core

uniform mat4 clip_from_marker;

in vec2 in_position;

out vec2 ground;  // metres, marker frame

void main() {
    ground = in_position;
    gl_Position = clip_from_marker * vec4(in_position, 0.0, 1.0);
}
