// Covers the whole framebuffer, for passes without a vertex shader of their own. A scissor restricts them to a part of it.
#version 330 core

void main() {
    gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0, 0.0, 1.0);
}
