// Chooses the pixels with the real object's outline within reach of the blur across it.
#version 330 core
#include "compositing/middle.glsl"

uniform sampler2D coarse_gone;
uniform sampler2D silhouette;
uniform vec4 around_object;  // the pixels of the layers in which the outline may be near: left, bottom, right, top
uniform float reach_px;

float object_at(vec2 middle) {
    return textureLod(silhouette, middle / vec2(textureSize(silhouette, 0)), 0.0).r;
}

void main() {
    vec2 middle = middle_of_blurs();
    if (any(lessThan(middle, around_object.xy)) || any(greaterThan(middle, around_object.zw))) discard;
    if (textureLod(coarse_gone, in_coarse(middle, coarse_gone), 0.0).a < 0.01) discard;
    float sum = object_at(middle + vec2(reach_px, 0.0)) + object_at(middle - vec2(reach_px, 0.0));
    sum += object_at(middle + vec2(0.0, reach_px)) + object_at(middle - vec2(0.0, reach_px));
    if (sum < 0.01 || sum > 3.99) discard;
}
