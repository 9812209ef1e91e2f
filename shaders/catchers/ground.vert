// The polygon of the marker's plane that the model may darken.
#version 330 core

uniform mat4 clip_from_marker;
uniform mat4 placed_from_marker;

in vec2 in_position;

out vec2 ground;  // metres, marker frame
out vec2 ground_placed;  // metres, in the frame of the model before it was moved by hand

void main() {
    ground = in_position;
    ground_placed = (placed_from_marker * vec4(in_position, 0.0, 1.0)).xy;
    gl_Position = clip_from_marker * vec4(in_position, 0.0, 1.0);
}
