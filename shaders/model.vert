// The model in the camera's view.
#version 330 core

uniform mat4 clip_from_marker;
uniform mat4 marker_from_placed;  // a similarity

in vec3 in_position;
in vec3 in_normal;
#ifdef HAS_MAPS
in vec2 in_uv;
out vec2 uv;
#endif
#ifdef VERTEX_COLOURS
in vec4 in_colour;
out vec4 colour;
#endif

out vec3 position;  // metres, marker frame
out vec3 normal;

void main() {
    position = (marker_from_placed * vec4(in_position, 1.0)).xyz;
    normal = mat3(marker_from_placed) * in_normal;
#ifdef HAS_MAPS
    uv = in_uv;
#endif
#ifdef VERTEX_COLOURS
    colour = in_colour;
#endif
    gl_Position = clip_from_marker * vec4(position, 1.0);
}
