// Both layers blurred along one axis, into pixels of half the resolution.
#version 330 core

uniform sampler2D added_light;
uniform sampler2D removed;
uniform vec2 texel;  // of what is drawn, in coordinates of what is read
uniform vec2 along;  // from one tap to the next, in the same; between four pixels the first time, so that a tap is their mean
uniform float weights[TAPS + 1];  // of the middle, and of its neighbours on either side

layout(location = 0) out vec4 coarse_light;
layout(location = 1) out vec4 coarse_gone;

void main() {
    vec2 at = gl_FragCoord.xy * texel;
    coarse_light = coarse_gone = vec4(0.0);
    for (int tap = -TAPS; tap <= TAPS; ++tap) {
        float weight = weights[abs(tap)];
        vec2 there = at + float(tap) * along;
        coarse_light += weight * textureLod(added_light, there, 0.0);
        coarse_gone += weight * textureLod(removed, there, 0.0);
    }
}
