// The whole viewport.
#version 330 core

out vec2 at;  // the video's coordinates, bottom row first

void main() {
    at = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    gl_Position = vec4(at * 2.0 - 1.0, 0.0, 1.0);
}
