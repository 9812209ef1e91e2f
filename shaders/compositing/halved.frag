// Both layers at half the resolution, as means of two by two pixels. What the video's border cuts off goes on beyond it.
#version 330 core
#include "catchers/removable.glsl"

uniform sampler2D added_light;
uniform sampler2D removed;
uniform ivec2 first;  // the video's lower left pixel
uniform ivec2 last;  // its upper right pixel

layout(location = 0) out vec4 halved_light;  // clipped to what a picture can show, as cameras clip before they blur colours
layout(location = 1) out vec4 halved_gone;  // alpha: 0 if nothing is drawn there, else as marked

// The mark of pixels that differ by so much at most; and of those at the border of a shadow in the video, whose ground differs
// in what is removable.
float marked(float difference, float least_number, float most_number) {
    bool is_border = most_number - least_number > AT_BORDER * (NONE_REMOVABLE - ALL_REMOVABLE);
    return is_border && is_ground(least_number) && is_ground(most_number) ? 3.0 : 1.0 + min(difference, 0.4);
}

void main() {
    ivec2 lower = 2 * ivec2(gl_FragCoord.xy);
    vec4 light = vec4(0.0), least_light = vec4(1e4), most_light = vec4(-1e4);
    vec4 gone = vec4(0.0), least_gone = vec4(1e4), most_gone = vec4(-1e4);
    for (int k = 0; k < 4; ++k) {
        ivec2 at = clamp(lower + ivec2(k & 1, k >> 1), first, last);
        vec4 light_there = texelFetch(added_light, at, 0), gone_there = texelFetch(removed, at, 0);
        light += 0.25 * min(light_there, 1.0);
        gone += 0.25 * gone_there;
        least_light = min(least_light, light_there);
        most_light = max(most_light, light_there);
        least_gone = min(least_gone, gone_there);
        most_gone = max(most_gone, gone_there);
    }
    vec4 differs = max(most_light - least_light, vec4(most_gone.rgb - least_gone.rgb, 0.0));
    bool is_empty = most_light == vec4(0.0) && least_gone.rgb == vec3(0.0) && most_gone.rgb == vec3(0.0);
    float difference = max(max(differs.r, differs.g), max(differs.b, differs.a));
    halved_light = light;
    halved_gone = vec4(gone.rgb, is_empty ? 0.0 : marked(difference, least_gone.a, most_gone.a));
}
