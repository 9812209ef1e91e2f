// Morphological antialiasing (Reshetov, HPG 2009) of the model's outlines, of those of its parts before one another, and of
// the real object's and its sides' where they end the model's shadow, in layers drawn with one sample a pixel. Such an outline is a
// staircase. From how its steps follow one another it is computed what part of each pixel lies beyond the line that they
// stand for; that part is given what the layers show beyond the step. Three passes: FIND the steps, compute what the layers
// become there, and PUT_BACK the result.
#version 330 core

uniform sampler2D added_light;
uniform sampler2D removed;
#ifndef PUT_BACK
uniform ivec2 first;  // the video's lower left pixel: what its border cuts off has no outline there
uniform ivec2 last;  // its upper right pixel
#endif

#if defined(FIND)
#include "screen/srgb.glsl"
out vec4 steps;  // whether there is a step to the right, above, to the left and below; pixels without any are not chosen

const float SEEN = 0.35;  // the least difference at a step, as a share of the brighter pixel's light
const float LEAST_SEEN = 0.03;  // and in linear light
const float OTHER_SURFACE = 0.004;  // difference of the numbers of two surfaces (model.frag): four steps of half precision

const float ENDS = 0.1;  // the least difference in what is gone of the video's light where the real object's edge ends a shadow
const float OBJECT = -0.2;  // below the ground's numbers and above those of the real object's sides (real_object.frag)
const float FOLD = 0.05;  // the least difference of the numbers of two sides that meet in an edge and not in a round surface

// A pixel's brightness, its coverage, the number of the surface that it shows, and what is gone there of the video's light.
vec4 seen(ivec2 at) {
    ivec2 within = clamp(at, first, last);
    vec4 light = texelFetch(added_light, within, 0), gone = texelFetch(removed, within, 0);
    return vec4(dot(light.rgb, LUMINANCE), light.a, gone.a, dot(gone.rgb, LUMINANCE));
}

// Whether there is a step between two pixels. Within one surface there is none: its texture has been filtered already.
float differs(vec4 one, vec4 other) {
    bool is_seen = abs(one.x - other.x) > max(SEEN * max(one.x, other.x), LEAST_SEEN);
    bool is_other = is_seen && abs(one.z - other.z) > OTHER_SURFACE;
    // Of what no model covers, ground.frag gives the ground a number below 0, and real_object.frag the sides of a real object
    // that may be shaded lower ones. One that is not has 0, as has what is beyond the ground. Rims of leaves, which are smooth
    // already, have one above 0.
    float lower = min(one.z, other.z), upper = max(one.z, other.z);
    bool is_outline = upper == 0.0 ? lower < 0.0 : upper < 0.0 && lower < OBJECT && upper - lower > FOLD;
    bool ends = max(one.y, other.y) < 0.5 && is_outline && abs(one.w - other.w) > ENDS;
    return is_other || ends || abs(one.y - other.y) > 0.5 ? 1.0 : 0.0;
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 own = seen(at);
    steps = vec4(
        differs(own, seen(at + ivec2(1, 0))),
        differs(own, seen(at + ivec2(0, 1))),
        differs(own, seen(at - ivec2(1, 0))),
        differs(own, seen(at - ivec2(0, 1)))
    );
    if (steps == vec4(0.0)) discard;
}
#else
layout(location = 0) out vec4 smooth_light;
layout(location = 1) out vec4 smooth_gone;
#endif

#if defined(PUT_BACK)
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    smooth_light = texelFetch(added_light, at, 0);
    smooth_gone = texelFetch(removed, at, 0);
}
#elif !defined(FIND)
uniform sampler2D outline_steps;

const int FARTHEST = 12;  // pixels along a step: a longer one counts as level

// Whether there is a step between a pixel and its neighbour in one of the four directions.
bool is_step(ivec2 at, ivec2 towards) {
    vec4 steps = texelFetch(outline_steps, clamp(at, first, last), 0);
    vec2 ahead = towards.x + towards.y > 0 ? steps.xy : steps.zw;
    return (towards.x != 0 ? ahead.x : ahead.y) > 0.5;
}

// The distance from the middle of a pixel to where its step towards `across` ends. `rises`: whether the line there is half a
// pixel beyond the step (0.5) or before it (-0.5), or the staircase does not go on there (0).
float length_of_step(ivec2 at, ivec2 across, ivec2 along, out float rises) {
    float length = 0.5;
    bool turns = false, turns_beyond = false;
    for (int pixel = 1; pixel <= FARTHEST; ++pixel) {
        turns = is_step(at, along);
        turns_beyond = is_step(at + across, along);
        if (turns || turns_beyond || !is_step(at + along, across)) break;
        at += along;
        length += 1.0;
    }
    rises = turns == turns_beyond ? 0.0 : turns ? -0.5 : 0.5;
    // A turn that goes on for more than a pixel is a corner and no step of a line.
    if (is_step(turns ? at - across : at + 2 * across, along)) rises = 0.0;
    return length;
}

// The part of a pixel that lies beyond the line, which rises linearly from the middle of the step to its ends.
float beyond(ivec2 at, ivec2 across) {
    ivec2 along = across.yx;
    float ahead, behind;
    float end = length_of_step(at, across, along, ahead);
    float start = -length_of_step(at, across, -along, behind);
    float middle = 0.5 * (start + end), half_length = 0.5 * (end - start);
    float share = 0.0;
    for (int quarter = 0; quarter < 4; ++quarter) {
        float from_middle = (0.25 * float(quarter) - 0.375 - middle) / half_length;
        share += 0.25 * max(0.0, -abs(from_middle) * (from_middle > 0.0 ? ahead : behind));
    }
    return is_step(at, across) ? share : 0.0;
}

void main() {
    const ivec2 RIGHT = ivec2(1, 0), UP = ivec2(0, 1);
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec2 aside = vec2(beyond(at, RIGHT), beyond(at, -RIGHT));
    vec2 upright = vec2(beyond(at, UP), beyond(at, -UP));
    // A pixel may have steps in both directions, but only one line passes through it: the one that takes the larger part.
    bool is_steep = aside.x + aside.y > upright.x + upright.y;
    vec2 shares = is_steep ? aside : upright;
    ivec2 across = is_steep ? RIGHT : UP;
    ivec2 further = clamp(at + across, first, last), nearer = clamp(at - across, first, last);
    float left = 1.0 - shares.x - shares.y;
    smooth_light = left * texelFetch(added_light, at, 0) + shares.x * texelFetch(added_light, further, 0)
        + shares.y * texelFetch(added_light, nearer, 0);
    smooth_gone = left * texelFetch(removed, at, 0) + shares.x * texelFetch(removed, further, 0)
        + shares.y * texelFetch(removed, nearer, 0);
}
#endif
