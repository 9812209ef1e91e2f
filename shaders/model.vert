// The model as the camera sees it.
#version 330 core

uniform mat4 clip_from_marker;
uniform mat4 marker_from_placed;  // a similarity transform

in vec3 in_position;
in vec3 in_normal;
in vec4 in_openness;
#ifdef HAS_MAPS
in vec2 in_uv;
#ifdef LAID_OUT
#ifdef MORE_UVS
in vec2 in_more_uv;
#endif
out vec4 uvs;  // two sets of texture coordinates
#else
out vec2 uv;
#endif
#endif
#ifdef VERTEX_COLOURS
in vec4 in_colour;
centroid out vec4 colour;
#endif

out vec3 position;  // metres, marker frame
centroid out vec3 normal;
centroid out vec4 openness;

void main() {
    position = (marker_from_placed * vec4(in_position, 1.0)).xyz;
    normal = mat3(marker_from_placed) * in_normal;
    openness = in_openness;
#ifdef LAID_OUT
#ifdef MORE_UVS
    uvs = vec4(in_uv, in_more_uv);
#else
    uvs = vec4(in_uv, 0.0, 0.0);
#endif
#elif defined(HAS_MAPS)
    uv = in_uv;
#endif
#ifdef VERTEX_COLOURS
    colour = in_colour;
#endif
    gl_Position = clip_from_marker * vec4(position, 1.0);
}
