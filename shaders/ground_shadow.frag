// The fraction of one sun's light that one caster lets through to the ground.
#version 330 core
#include "shadow.glsl"

uniform int caster;
uniform int light;

in vec3 position;
out float lit;

void main() {
    lit = lit_past(caster, light, position);
}
