// Occlusion of the ground by the model from some directions of the sky, and their horizontal parts where hidden.
#version 330 core
#include "lights.glsl"
#include "shadow.glsl"

uniform float weight;  // of a direction straight above

in vec3 position;
out vec4 occlusion;

void main() {
    occlusion = vec4(0.0);
    for (int light = 0; light < LIGHTS; ++light) {
        vec3 direction = light_point[light].xyz;
        occlusion += weight * direction.z * (1.0 - lit_past(0, light, position)) * vec4(1.0, direction.xy, 0.0);
    }
}
