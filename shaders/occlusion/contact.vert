// Maps the patch of ground around the model, seen from straight above, to the whole texture.
#version 330 core

uniform vec4 patch_bounds;  // lower x, y and upper x, y; metres, the model's own frame

out vec3 position;

void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    position = vec3(mix(patch_bounds.xy, patch_bounds.zw, corner), 0.0);
    gl_Position = vec4(corner * 2.0 - 1.0, 0.0, 1.0);
}
