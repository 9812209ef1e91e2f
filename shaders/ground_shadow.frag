// The fraction of one light that one caster lets through to the ground.
#version 330 core
#include "lights.glsl"
#include "shadow.glsl"

uniform int caster;
uniform int light;

in vec3 ground;
out float lit;

void main() {
    // Above a lamp's horizon there is no ground.
    lit = ground.z < 1e-4 ? 1.0 : lit_past(caster, light, vec3(ground.xy / ground.z, 0.0));
}
