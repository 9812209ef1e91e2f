// The fraction of its light that the real object loses where the model blocks a light.
#version 330 core
#define OVER_PIXELS
#include "lights/lights.glsl"
#include "lights/shadow.glsl"
#include "model/triangle.glsl"

uniform vec3 sky;
uniform vec3 ground_bounce;
#if LIGHTS > 0
uniform vec3 light_irradiance[LIGHTS];
#endif

in vec3 position;
layout(location = 0) out vec4 added_light;  // stays empty
layout(location = 1) out vec4 removed;  // alpha: by which outlines.frag tells its sides from each other and from all else

// From -0.25 down, and hardly ever alike for sides that face different ways.
float number_of_side(vec3 normal) {
    return -0.5 - dot(normal, vec3(0.13, 0.18, 0.11));
}

void main() {
    vec3 normal = triangle_normal(position, vec3(0.0, 0.0, 1.0));
    float upward = 0.5 + 0.5 * normal.z;
    vec3 before = sky * upward + ground_bounce * bounce_at(position, normal) * (1.0 - upward);
    vec3 after = before;
#if LIGHTS > 0
    for (int light = 0; light < LIGHTS; ++light) {
        // Parts of the object that face away from a light receive none of it anyway.
        float falloff;
        vec3 seen = light_irradiance[light] * max(0.0, dot(normal, towards_light(light, position, falloff)));
        seen *= falloff;
        before += seen;
        after += seen * lit_past_models(light, position);
    }
#endif
    added_light = vec4(0.0);
    removed = vec4(1.0 - after / max(before, 1e-3), number_of_side(normal));
}
