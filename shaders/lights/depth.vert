// The model as the light sees it.
#version 330 core

uniform mat4 clip_from_marker;

in vec3 in_position;
#ifdef BASE_MAP
#define HAS_MAPS
#endif
#include "model/uvs.glsl"
#ifdef VERTEX_COLOURS
in vec4 in_colour;
out vec4 colour;
#endif
#ifdef BLEND
out vec3 position;
#endif

void main() {
    pass_uvs();
#ifdef VERTEX_COLOURS
    colour = in_colour;
#endif
#ifdef BLEND
    position = in_position;
#endif
    gl_Position = clip_from_marker * vec4(in_position, 1.0);
}
