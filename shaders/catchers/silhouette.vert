#version 330 core

uniform mat4 clip_from_marker;

in vec3 in_position;

void main() {
    gl_Position = clip_from_marker * vec4(in_position, 1.0);
}
