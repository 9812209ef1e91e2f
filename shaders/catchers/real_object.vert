// The proxy of the real object as the camera sees it.
#version 330 core

uniform mat4 clip_from_marker;

in vec3 in_position;
in vec3 in_normal;

out vec3 position;  // metres, marker frame
out vec3 smooth_normal;

void main() {
    position = in_position;
    smooth_normal = in_normal;
    gl_Position = clip_from_marker * vec4(in_position, 1.0);
}
