// The model in the light's view.
#version 330 core

uniform mat4 clip_from_marker;

in vec3 in_position;
#ifdef BASE_MAP
in vec2 in_uv;
out vec2 uv;
#endif

void main() {
#ifdef BASE_MAP
    uv = in_uv;
#endif
    gl_Position = clip_from_marker * vec4(in_position, 1.0);
}
