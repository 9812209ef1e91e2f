// The model as the camera sees it.
#version 330 core

uniform mat4 clip_from_marker;
uniform mat4 marker_from_placed;  // a similarity transform

in vec3 in_position;
in vec3 in_normal;
in vec4 in_openness;
#include "model/uvs.glsl"
#ifdef VERTEX_COLOURS
in vec4 in_colour;
centroid out vec4 colour;
#endif

out vec3 position;  // metres, marker frame
centroid out vec3 normal;
centroid out vec4 openness;
#ifdef ROUNDED
// The matrix n n^T of each vertex's unit normal n, row by row from the diagonal on, and that matrix times its position.
out vec3 tangent_planes[2];
out vec3 at_tangent_planes;
#endif

void main() {
    position = (marker_from_placed * vec4(in_position, 1.0)).xyz;
    normal = mat3(marker_from_placed) * in_normal;
    openness = in_openness;
#ifdef ROUNDED
    vec3 n = normalize(normal);
    tangent_planes[0] = n.x * n;
    tangent_planes[1] = vec3(n.y * n.yz, n.z * n.z);
    at_tangent_planes = dot(n, position) * n;
#endif
    pass_uvs();
#ifdef VERTEX_COLOURS
    colour = in_colour;
#endif
    gl_Position = clip_from_marker * vec4(position, 1.0);
}
