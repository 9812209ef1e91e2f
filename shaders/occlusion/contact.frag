// How much of the ground's sky the model hides: for a few directions of the sky at a time, those that are hidden are summed,
// and their horizontal parts with them.
#version 330 core
#include "lights/lights.glsl"
#include "lights/shadow.glsl"

uniform float weight;  // of a direction straight up

in vec3 position;
out vec4 occlusion;

void main() {
    occlusion = vec4(0.0);
    for (int light = 0; light < LIGHTS; ++light) {
        vec3 direction = light_point[light].xyz;
        occlusion += weight * direction.z * (1.0 - lit_past(0, light, position)) * vec4(1.0, direction.xy, 0.0);
    }
}
