// Occlusion of the ground by the model from one direction of the sky.
#version 330 core
#include "lights.glsl"
#include "shadow.glsl"

uniform float weight;

in vec3 position;
out float occlusion;

void main() {
    occlusion = weight * (1.0 - lit_past(0, 0, position));
}
