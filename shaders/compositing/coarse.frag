// Blurs both layers, at half the resolution, along one axis.
#version 330 core

uniform sampler2D added_light;
uniform sampler2D removed;  // alpha as in halved.frag
uniform ivec2 along;  // offset from one tap to the next
uniform float weights[TAPS + 1];  // of the middle tap, and of its neighbours on either side

layout(location = 0) out vec4 coarse_light;
layout(location = 1) out vec4 coarse_gone;  // alpha: 0 if nothing is within the taps' reach, else as halved.frag marks it,
                                           // by the largest difference of the layers within SPREAD pixels

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), last = textureSize(added_light, 0) - 1;
    vec4 light = texelFetch(added_light, at, 0), gone = texelFetch(removed, at, 0);
    coarse_light = weights[0] * light;
    coarse_gone = weights[0] * gone;
    float unlike = gone.a, touched = gone.a;
    vec4 differs = vec4(0.0);
    for (int tap = 1; tap <= TAPS; ++tap) {
        for (int side = -1; side <= 1; side += 2) {
            ivec2 there = clamp(at + side * tap * along, ivec2(0), last);
            vec4 light_there = texelFetch(added_light, there, 0), gone_there = texelFetch(removed, there, 0);
            coarse_light += weights[tap] * light_there;
            coarse_gone += weights[tap] * gone_there;
            touched = max(touched, gone_there.a);
            if (tap <= SPREAD) unlike = max(unlike, gone_there.a);
            if (tap == 1) differs = max(differs, max(abs(light_there - light), vec4(abs(gone_there.rgb - gone.rgb), 0.0)));
        }
    }
    float most = max(max(differs.r, differs.g), max(differs.b, differs.a));
    coarse_gone.a = touched > 0.0 ? max(unlike, 1.0 + min(most, 0.4)) : 0.0;
}
