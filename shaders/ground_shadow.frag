// The fraction of a light that a caster lets through to the ground, for one light and one caster.
#version 330 core
#include "lights.glsl"
#include "shadow.glsl"

uniform int caster;
uniform int light;

in vec3 ground;
out float lit;

void main() {
    // Rays above the horizon of a lamp never meet the ground.
    lit = ground.z < 1e-4 ? 1.0 : lit_past(caster, light, vec3(ground.xy / ground.z, 0.0));
}
