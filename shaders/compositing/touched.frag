// Chooses the pixels that the composite may change: those with something in the layers within reach of its blurs.
#version 330 core
#include "compositing/middle.glsl"

uniform sampler2D coarse_gone;

void main() {
    vec2 middle = middle_of_blurs();
    if (textureLod(coarse_gone, in_coarse(middle, coarse_gone), 0.0).a < 0.01) discard;
}
