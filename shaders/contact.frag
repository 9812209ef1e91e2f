// Occlusion of the ground by the model from one direction of the sky, and that direction's horizontal part if hidden.
#version 330 core
#include "lights.glsl"
#include "shadow.glsl"

uniform float weight;

in vec3 position;
out vec4 occlusion;

void main() {
    occlusion = weight * (1.0 - lit_past(0, 0, position)) * vec4(1.0, light_point[0].xy, 0.0);
}
