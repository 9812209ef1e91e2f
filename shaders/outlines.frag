// Outlines of the model, and of its parts before one another, where pixels were drawn whole or not at all: from how the
// steps of that staircase follow one another, what part of each pixel is beyond the line that they stand for (Reshetov,
// "Morphological antialiasing", HPG 2009). That part becomes what the layers show beyond the step.
#version 330 core

uniform sampler2D added_light;
uniform sampler2D removed;

layout(location = 0) out vec4 smooth_light;
layout(location = 1) out vec4 smooth_gone;

#ifdef PUT_BACK
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    smooth_gone = texelFetch(removed, at, 0);
    if (smooth_gone.a < 0.0) discard;  // nothing has been smoothed here
    smooth_light = texelFetch(added_light, at, 0);
}
#else
const int FARTHEST = 12;  // pixels along a step: a longer one counts as level

const vec3 LUMINANCE = vec3(0.2126, 0.7152, 0.0722);
const float SEEN = 0.35;  // of the brighter one's light, that pixels differ by where there is a step between them
const float LEAST_SEEN = 0.03;  // linear

// Brightness, and how much is covered by what is drawn.
vec2 seen(ivec2 at) {
    vec4 light = texelFetch(added_light, clamp(at, ivec2(0), textureSize(added_light, 0) - 1), 0);
    return vec2(dot(light.rgb, LUMINANCE), light.a);
}

bool differ(vec2 one, vec2 other) {
    return abs(one.x - other.x) > max(SEEN * max(one.x, other.x), LEAST_SEEN) || abs(one.y - other.y) > 0.5;
}

// From the middle of a pixel to where its step towards `across` ends; `rises`: whether the line there is half a pixel
// beyond the step (0.5) or before it, or the step is level.
float length_of_step(ivec2 at, ivec2 across, ivec2 along, vec2 own, vec2 other, out float rises) {
    float steps = 0.5;
    rises = 0.0;
    for (int step = 1; step <= FARTHEST; ++step) {
        at += along;
        vec2 here = seen(at), beyond = seen(at + across);
        bool turns = differ(here, own), turns_beyond = differ(beyond, other);
        if (turns || turns_beyond) {
            rises = turns == turns_beyond ? 0.0 : turns ? -0.5 : 0.5;
            break;
        }
        steps += 1.0;
    }
    // Where the turn goes on for more than a pixel it is a corner, and no step of a line.
    bool is_corner = rises < 0.0 ? differ(seen(at - across), own) : differ(seen(at + 2 * across), other);
    if (is_corner) rises = 0.0;
    return steps;
}

// The part of a pixel beyond the line, which rises linearly from the middle of the step to its ends.
float beyond(ivec2 at, ivec2 across, vec2 own) {
    vec2 other = seen(at + across);
    if (!differ(own, other)) return 0.0;
    ivec2 along = across.yx;
    float ahead, behind;
    float end = length_of_step(at, across, along, own, other, ahead);
    float start = -length_of_step(at, across, -along, own, other, behind);
    float middle = 0.5 * (start + end), half_length = 0.5 * (end - start);
    float share = 0.0;
    for (int quarter = 0; quarter < 4; ++quarter) {
        float from_middle = (0.25 * float(quarter) - 0.375 - middle) / half_length;
        share += 0.25 * max(0.0, -abs(from_middle) * (from_middle > 0.0 ? ahead : behind));
    }
    return share;
}

void main() {
    const ivec2 RIGHT = ivec2(1, 0), UP = ivec2(0, 1);
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec2 own = seen(at);
    bool is_aside = differ(own, seen(at + RIGHT)) || differ(own, seen(at - RIGHT));
    if (!is_aside && !differ(own, seen(at + UP)) && !differ(own, seen(at - UP))) discard;
    vec2 aside = vec2(beyond(at, RIGHT, own), beyond(at, -RIGHT, own));
    vec2 upright = vec2(beyond(at, UP, own), beyond(at, -UP, own));
    // Steps that follow one another in both directions stand for one line.
    bool is_steep = aside.x + aside.y > upright.x + upright.y;
    vec2 shares = is_steep ? aside : upright;
    ivec2 across = is_steep ? RIGHT : UP;
    if (shares.x + shares.y < 0.004) discard;
    ivec2 last = textureSize(removed, 0) - 1;
    ivec2 further = clamp(at + across, ivec2(0), last), nearer = clamp(at - across, ivec2(0), last);
    float left = 1.0 - shares.x - shares.y;
    smooth_light = left * texelFetch(added_light, at, 0) + shares.x * texelFetch(added_light, further, 0)
        + shares.y * texelFetch(added_light, nearer, 0);
    smooth_gone = left * texelFetch(removed, at, 0) + shares.x * texelFetch(removed, further, 0)
        + shares.y * texelFetch(removed, nearer, 0);
}
#endif
