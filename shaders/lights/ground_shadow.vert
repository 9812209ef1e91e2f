// The part of the ground that one tile shows, aligned with the light's view.
#version 330 core

uniform mat4 marker_from_tile;  // where the light's rays meet the marker's plane

out vec3 ground;  // x, y, w; metres, marker frame

void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    ground = (marker_from_tile * vec4(corner, 0.0, 1.0)).xyw;
    gl_Position = vec4(corner * 2.0 - 1.0, 0.0, 1.0);
}
