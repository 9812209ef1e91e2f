// The real object's silhouette, and beside it the mean of each pixel and its four neighbours.
#version 330 core

uniform sampler2D silhouette;

out vec2 with_mean;

float object_at(ivec2 at) {
    return texelFetch(silhouette, clamp(at, ivec2(0), textureSize(silhouette, 0) - 1), 0).r;
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    float own = object_at(at);
    float beside = object_at(at + ivec2(1, 0)) + object_at(at - ivec2(1, 0)) + object_at(at + ivec2(0, 1)) + object_at(at - ivec2(0, 1));
    with_mean = vec2(own, 0.2 * (own + beside));
}
