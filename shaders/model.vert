// The model in the camera's view.
#version 330 core

uniform mat4 clip_from_marker;

in vec3 in_position;
in vec3 in_normal;
in vec2 in_uv;
in vec4 in_colour;

out vec3 position;  // metres, marker frame
out vec3 normal;
out vec2 uv;
out vec4 colour;

void main() {
    position = in_position;
    normal = in_normal;
    uv = in_uv;
    colour = in_colour;
    gl_Position = clip_from_marker * vec4(in_position, 1.0);
}
