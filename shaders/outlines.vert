// The whole framebuffer; the scissor restricts it to the part of the picture that may change.
#version 330 core

void main() {
    gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0, 0.0, 1.0);
}
