// The light's sign as the camera sees it.
#version 330 core

uniform mat4 clip_from_marker;
uniform mat4 marker_from_sign;

in vec3 in_position;
in vec3 in_normal;

out vec3 position;  // metres, marker frame
out vec3 normal;

void main() {
    vec4 placed = marker_from_sign * vec4(in_position, 1.0);
    position = placed.xyz;
    normal = mat3(marker_from_sign) * in_normal;
    gl_Position = clip_from_marker * placed;
}
