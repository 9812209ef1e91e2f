// Both layers blurred along one axis, into pixels of half the resolution.
#version 330 core

uniform sampler2D added_light;
uniform sampler2D removed;
uniform vec2 texel;  // of what is drawn, in coordinates of what is read
uniform vec2 along;  // from one tap to the next, in the same; between four pixels the first time, so that a tap is their mean
uniform float weights[TAPS + 1];  // of the middle, and of its neighbours on either side

layout(location = 0) out vec4 coarse_light;
layout(location = 1) out vec4 coarse_gone;

#if HALVES
// The mean of the four pixels around a corner, none brighter than a picture shows: a camera's colours are blurred after that.
vec4 clipped_around(vec2 corner) {
    ivec2 last = textureSize(added_light, 0) - 1, upper = ivec2(round(corner * vec2(last + 1)));
    vec4 sum = vec4(0.0);
    for (int k = 0; k < 4; ++k) {
        sum += min(texelFetch(added_light, clamp(upper - ivec2(k & 1, k >> 1), ivec2(0), last), 0), vec4(1.0));
    }
    return 0.25 * sum;
}
#define LIGHT_AT(there) clipped_around(there)
#else
#define LIGHT_AT(there) textureLod(added_light, there, 0.0)
#endif

void main() {
    vec2 at = gl_FragCoord.xy * texel;
    coarse_light = coarse_gone = vec4(0.0);
    for (int tap = -TAPS; tap <= TAPS; ++tap) {
        float weight = weights[abs(tap)];
        vec2 there = at + float(tap) * along;
        coarse_light += weight * LIGHT_AT(there);
        coarse_gone += weight * textureLod(removed, there, 0.0);
    }
}
