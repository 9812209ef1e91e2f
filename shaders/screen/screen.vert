// A rectangle of the viewport from four vertices; its picture's bottom row comes first.
#version 330 core

uniform vec4 rectangle;  // left, bottom, right, top in clip coordinates

out vec2 uv;

void main() {
    uv = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    gl_Position = vec4(mix(rectangle.xy, rectangle.zw, uv), 0.0, 1.0);
}
