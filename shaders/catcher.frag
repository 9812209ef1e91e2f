// The fraction of light that the ground loses where the model blocks it, by the measured ratio of the real shadow, except
// where the real object's shadow has darkened it already. It is less than nothing where the model's lit sides light it.
#version 330 core
#include "srgb.glsl"
#include "lights.glsl"
#include "ground_shadow.glsl"

uniform sampler2D video;
uniform vec4 viewport;  // left, bottom, width, height in pixels
uniform vec3 sky;  // its fraction of the light on level ground at the marker, linear RGB; the lights' are the rest
uniform vec3 sky_slope[2];  // what surfaces that face x and y get of it beyond that of an even one
#if LIGHTS > 0 && CASTERS > 1
uniform vec3 ground_rgb;  // colour of the lit ground at the marker in the video, linear; 0 if it is not known
const float RIM_PX = 2.5;  // error of the real shadow's outline
const float MATTERS = 0.02;  // share of the sky or of a light that the model takes
const float BORDER_PX = 2.0;  // from within a border to lit ground
const float NEAR_SHADOW = 1.0 / 16.0;  // of a light, that the real object takes near what may be its shadow's border
const float FAR_RIM = 0.012;  // its error where the proxy is a poor one: a fraction of the picture's width
#endif
// Fraction of the sky that the model hides, and its mean direction's x and y times that, as they end in the model's shadow;
// alpha: the part of these that counts on lit ground.
uniform sampler2D contact;
uniform vec4 patch_bounds;  // lower x, y and upper x, y of `contact`; metres, the model's own frame
uniform sampler2D walls;  // light of the ground on what is seen of the nearest wall, over pi; the same places
uniform mat4 marker_from_placed;
uniform vec3 model_albedo;  // its mean, linear RGB
uniform vec3 ground_bounce;
#if LIGHTS > 0
uniform vec3 sun[LIGHTS];  // irradiance over pi across the light's direction
#endif

#ifdef COVERS
#include "cover.glsl"
#endif
// Of a pixel's side, the width of the texels looked at, lest leaves' shadows that are finer than a pixel break up. Their
// interpolation blurs by 0.6 of a pixel's own area, which the composite adds: with more, borders are too wide for the lens.
const float TEXEL_SIDES = 0.45;
uniform float strength;  // 0: the model darkens nothing
#ifdef SOFT_BORDER
uniform float border_px;  // standard deviation of the real shadow's border beyond what lens and sun explain
#endif

in vec2 ground;
in vec2 ground_placed;
layout(location = 0) out vec4 added_light;  // none; alpha: where the cover is seen, as in cover.glsl
layout(location = 1) out vec4 removed;

vec3 video_at(vec2 pixel) {
    return linear_from_srgb(texture(video, (pixel - viewport.xy) / viewport.zw).rgb);
}

#if LIGHTS > 0 && CASTERS > 1
const vec3 LUMINANCE = vec3(0.2126, 0.7152, 0.0722);

// Fraction of a light that the real object lets through. Near its shadow's outline it is measured in the video, as an
// outline that is off by a pixel would leave a seam where the ground is darkened twice, or not at all. Farther away, what
// is clearly in shadow counts as such. Where the model changes next to nothing (not `matters`) so does an error.
float lit_past_real(int light, float covered, bool matters) {
    float known = lit_on_ground(1, light, ground);
    vec2 across = dFdx(ground), along = dFdy(ground);
    float least = known, most = known, far = known;
    float far_px = FAR_RIM * viewport.z;
    for (int side = matters ? -1 : 3; side <= 1; side += 2) {
        vec2 beside = vec2(lit_on_ground(1, light, ground + side * RIM_PX * across),
                           lit_on_ground(1, light, ground + side * RIM_PX * along));
        far = min(far, min(lit_on_ground(1, light, ground + side * far_px * across),
                           lit_on_ground(1, light, ground + side * far_px * along)));
        least = min(least, min(beside.x, beside.y));
        most = max(most, max(beside.x, beside.y));
    }
    float lit_ground = dot(ground_rgb, LUMINANCE);
    far = min(far, least);
    if (far == most || lit_ground <= 0.0 || covered > 0.0) return known;
    float share = dot(sun_on_ground[light], LUMINANCE) * ground_falloff(light, ground);
    float level = dot(level_at(ground), LUMINANCE);
    float seen = dot(video_at(gl_FragCoord.xy), LUMINANCE) / lit_ground;
    float gone = clamp((level - seen) / max(share, 1e-3), 0.0, 1.0);
    float measured = mix(known, 1.0 - gone, most - least);
#if LAMPS == 0
    // Beside lit ground is the shadow's border, where light is left that the model takes: else a bright line stays there.
    float brightest = seen;
    for (int side = -1; side <= 1; side += 2) {
        brightest = max(brightest, dot(video_at(gl_FragCoord.xy + vec2(side * BORDER_PX, 0.0)), LUMINANCE) / lit_ground);
        brightest = max(brightest, dot(video_at(gl_FragCoord.xy + vec2(0.0, side * BORDER_PX)), LUMINANCE) / lit_ground);
    }
    // What is hardly darker than lit ground is lit ground of another colour.
    float is_border = smoothstep(0.1, 0.35, gone) * (1.0 - smoothstep(0.4, 0.7, (level - brightest) / max(share, 1e-3)));
    float in_shadow = min(measured, 1.0 - smoothstep(0.4, 0.8, gone) * (most - far));
    return mix(in_shadow, 1.0 - gone, is_border * min((most - far) / NEAR_SHADOW, 1.0));
#else
    // Beside an object that a lamp lights, hidden sky is as dark as a shadow.
    return measured;
#endif
}
#endif

// Horizontal part of the mean direction to half of the sky, by cosine: that which a wall hides at its foot.
const float WALL = 0.4244;  // 4 / (3 pi)

void main() {
    vec2 at = (ground_placed - patch_bounds.xy) / (patch_bounds.zw - patch_bounds.xy);
    float covered = 0.0;
#ifdef COVERS
    covered = cover_at(ground).a;
#endif
    // What hides the sky is as much of a wall as it does so on one side; the rest of it hangs above.
    vec4 contact_here = texture(contact, at);
    vec3 hidden = contact_here.rgb;
    float shaded = 0.0;  // of the light that the model blocks most of
    float is_wall = min(length(hidden.yz) / max(WALL * hidden.x, 1e-4), 1.0);
    vec2 outward_placed = normalize(-hidden.yz + vec2(1e-9, 0.0));
    vec2 outward = normalize((marker_from_placed * vec4(outward_placed, 0.0, 0.0)).xy);
    vec3 on_walls = vec3(0.0);  // what the lights give them
    vec3 before = sky;
    vec3 after = sky;
#if LIGHTS > 0
    vec2 columns = dFdx(ground), rows = dFdy(ground);
    float texel_m = TEXEL_SIDES * sqrt(abs(columns.x * rows.y - columns.y * rows.x));
    for (int light = 0; light < LIGHTS; ++light) {
        float falloff;
        vec3 towards = towards_light(light, vec3(ground, 0.0), falloff);
#ifdef SOFT_BORDER
        // Four taps have the variance of their offsets.
        vec2 across = border_px * dFdx(ground), along = border_px * dFdy(ground);
        float lit = 0.25 * (lit_on_ground(0, light, ground + across + along) + lit_on_ground(0, light, ground + across - along)
            + lit_on_ground(0, light, ground - across + along) + lit_on_ground(0, light, ground - across - along));
#else
        float lit = lit_around(0, light, ground, texel_m);
#endif
        vec3 seen = sun_on_ground[light] * ground_falloff(light, ground);
        float share = 1.0;
#if CASTERS > 1
        share = lit_past_real(light, covered, max(hidden.x * contact_here.a, 1.0 - lit) > MATTERS);
        seen *= share;
#endif
        before += seen;
        after += seen * lit;
        shaded = max(shaded, 1.0 - lit);
        // A shadow on the ground goes on up the walls beside it.
        on_walls += sun[light] * (falloff * share * lit * max(dot(outward, towards.xy), 0.0));
    }
#endif
#ifdef CONTACT_ALONE
    // Drawn over a picture that has the shadows, and another model's contact.
    before = after;
#endif
    hidden *= mix(contact_here.a, 1.0, shaded);
    // In the place of the hidden sky the ground sees the model, lit by the ground before it, and if a wall by half the sky.
    vec3 from_ground = ground_bounce * after / max(before, 1e-3);
    vec3 on_wall = 0.5 * (sky + texture(walls, at).rgb) + on_walls;
    vec3 facing = model_albedo * mix(from_ground, on_wall, is_wall);
    // A sky whose radiance leans by k times a direction's x gives a wall that faces x a third of k more.
    vec2 hidden_from = (marker_from_placed * vec4(hidden.yz, 0.0, 0.0)).xy;
    hidden_from *= length(hidden.yz) / max(length(hidden_from), 1e-6);
    vec3 gone = hidden.x * sky + 3.0 * (sky_slope[0] * hidden_from.x + sky_slope[1] * hidden_from.y);
    after += hidden.x * facing - max(gone, 0.0);
    vec3 ratio = mix(vec3(1.0), after / max(before, 1e-3), strength);
    vec3 change = abs(1.0 - ratio);
    if (covered == 0.0 && max(change.r, max(change.g, change.b)) < 0.0005) discard;
    added_light = vec4(0.0);
#ifdef COVERS
    added_light.a = COVER_ALPHA * covered;
#endif
    removed = vec4(1.0 - ratio, 0.0);
}
