// The shadow catcher: the fraction of its light that the ground loses to the model, by the real shadow's measured ratio.
// Light that the real object's shadow has taken already is not taken again. Beside lit sides of the model, which reflect
// light onto the ground, the fraction is negative.
#version 330 core
#include "screen/srgb.glsl"
#include "lights/lights.glsl"
#include "lights/ground_shadow.glsl"

uniform sampler2D video;
uniform vec4 viewport;  // left, bottom, width, height in pixels
uniform vec3 sky;  // the sky's fraction of the light on level ground at the marker, linear RGB; the rest is the lights'
uniform vec3 sky_slope[2];  // what surfaces facing x and y get from the sky beyond the light of an even one
#if LIGHTS > 0 && CASTERS > GROUPS
uniform vec3 ground_rgb;  // linear colour of the lit ground at the marker in the video; 0 if unknown
const float RIM_PX = 2.5;  // error of the real shadow's outline
const float MATTERS = 0.02;  // share of the sky or of a light that the model takes, below which errors are not seen
const float BORDER_PX = 2.0;  // distance from inside a shadow's border to lit ground
const float NEAR_SHADOW = 1.0 / 16.0;  // share of a light that the real object takes close to the border of its shadow
// How far off the outline may be with a poor proxy, as a share of the picture's width; 0 where it follows the picture.
uniform float outline_error[LIGHTS];
// Cosine of the angle between the light and where the ground becomes lighter, from which on a shadow's outline is its foot.
const vec2 FOOT = vec2(0.15, 0.45);
#ifdef LIT_GROUND
// Ground near the border of the real object's shadow as the video shows it when it is lit; alpha: whether it is known.
uniform sampler2D lit_ground;
uniform vec4 lit_bounds;  // lower x, y and upper x, y of it; metres, marker frame
uniform vec3 shadow_ratio;  // of ground in that shadow over lit ground
// A camera's sharpening and its blur of colours make a border darker than the shadow, and brighter than lit ground, by no more.
const vec2 OVERSHOOT = vec2(0.6, 1.6);
#endif
#endif
// The fraction of the sky that the model hides, and that fraction times the x and y of the hidden part's mean direction,
// as far as both reach in the model's own shadow. Alpha: the part of them that counts on lit ground.
uniform sampler2D contact;
uniform vec4 patch_bounds;  // lower x, y and upper x, y of `contact`; metres, the model's own frame
uniform sampler2D walls;  // for the same places: the ground's light on the visible part of the nearest wall, over pi
uniform mat4 marker_from_placed;
uniform vec3 model_albedo;  // mean over the model, linear RGB
uniform vec3 ground_bounce;
#if LIGHTS > 0
uniform vec3 light_irradiance[LIGHTS];  // irradiance over pi across the light's direction
#endif

#include "catchers/removable.glsl"
#ifdef COVERS
#include "catchers/cover.glsl"
#endif
// Width of the texels to look up, in sides of a pixel, so that shadows finer than a pixel (leaves) do not break up. With their
// interpolation this blurs by 0.6 of the area of a pixel, by which the composite blurs as well: with wider texels, borders
// would be too wide for the lens.
const float TEXEL_SIDES = 0.45;
uniform float strength;  // 0: the model darkens nothing
#ifdef SOFT_BORDER
uniform float border_px;  // standard deviation of the real shadow's border beyond what lens and light explain
#endif

in vec2 ground;
in vec2 ground_placed;
layout(location = 0) out vec4 added_light;  // no light; alpha: where the cover is visible, as in cover.glsl
layout(location = 1) out vec4 removed;  // alpha: as in removable.glsl

vec3 video_at(vec2 pixel) {
    return linear_from_srgb(texture(video, (pixel - viewport.xy) / viewport.zw).rgb);
}

#if LIGHTS > 0 && CASTERS > GROUPS
// The fraction of a light that the real object lets through. Near the outline of its shadow it is measured in the video:
// where the two shadows meet, an outline that is off by a pixel would leave a seam that is darkened twice or not at all.
// Farther from the outline, only what is clearly in shadow in the video counts as shadow. Where the model takes hardly any
// light (not `matters`), an error would not be seen, and nothing is measured.
float lit_past_outline(int light, vec3 video_here, float covered, bool matters) {
    float known = lit_on_ground(GROUPS, light, ground);
    vec2 across = dFdx(ground), along = dFdy(ground);
    float least = known, most = known, far = known;
    float far_px = max(outline_error[light] * viewport.z, RIM_PX);
    vec2 rises = vec2(0.0);  // how the light changes along both axes of the picture
    for (int side = matters ? -1 : 3; side <= 1; side += 2) {
        vec2 beside = vec2(lit_on_ground(GROUPS, light, ground + side * RIM_PX * across),
                           lit_on_ground(GROUPS, light, ground + side * RIM_PX * along));
        vec2 farther = vec2(lit_on_ground(GROUPS, light, ground + side * far_px * across),
                            lit_on_ground(GROUPS, light, ground + side * far_px * along));
        rises += side * (beside + farther);
        far = min(far, min(farther.x, farther.y));
        least = min(least, min(beside.x, beside.y));
        most = max(most, max(beside.x, beside.y));
    }
    float lit_ground = dot(ground_rgb, LUMINANCE);
    far = min(far, least);
    if (far == most || lit_ground <= 0.0 || covered > 0.0) return known;
    // Towards the light a shadow begins at the object's foot. There the ground is dark because the object hides the sky.
    vec2 gradient = rises.x * vec2(along.y, -along.x) + rises.y * vec2(-across.y, across.x);
    gradient *= sign(across.x * along.y - across.y * along.x);
    vec2 towards = light_point[light].xy - light_point[light].w * ground;
    float is_foot = smoothstep(FOOT.x, FOOT.y, dot(gradient, towards) / max(length(gradient) * length(towards), 1e-9));
    float share = dot(light_ground_share[light], LUMINANCE) * ground_falloff(light, ground);
    float level = dot(level_at(ground), LUMINANCE);
    float seen = dot(video_here, LUMINANCE) / lit_ground;
    float gone = clamp((level - seen) / max(share, 1e-3), 0.0, 1.0);
    float measured = mix(known, 1.0 - gone, most - least);
#if LAMPS == 0
    // A pixel close to lit ground is on the border of the shadow. The light left there is taken by the model; otherwise a
    // bright line would remain.
    vec4 around;
    for (int place = 0; place < 4; ++place) {
        vec2 aside = BORDER_PX * vec2(place == 0 ? -1.0 : place == 1 ? 1.0 : 0.0, place == 2 ? -1.0 : place == 3 ? 1.0 : 0.0);
        around[place] = dot(video_at(gl_FragCoord.xy + aside), LUMINANCE) / lit_ground;
    }
    float brightest = max(seen, max(max(around.x, around.y), max(around.z, around.w)));
    // What is darker than the ground on either side of it is a joint or a letter.
    float is_line = smoothstep(0.1, 0.3, (max(min(around.x, around.y), min(around.z, around.w)) - seen) / max(share, 1e-3));
    // What is hardly darker than lit ground is no shadow's border, but lit ground of another colour.
    float is_border = smoothstep(0.1, 0.35, gone) * (1.0 - smoothstep(0.4, 0.7, (level - brightest) / max(share, 1e-3)));
    float in_shadow = min(measured, 1.0 - smoothstep(0.4, 0.8, gone) * (most - far));
    measured = mix(in_shadow, 1.0 - gone, is_border * min((most - far) / NEAR_SHADOW, 1.0));
    measured = mix(measured, known, is_line);
#endif
    // But no shadow is as bright as lit ground, wherever the foot was thought to be.
    return mix(measured, max(measured, known), is_foot);
}

// The same in each channel: where it is known what the ground looks like when it is lit, by that, as a shadow's border has
// other colours than either side.
vec3 lit_past_real(int light, float covered, bool matters) {
    vec3 video_here = video_at(gl_FragCoord.xy);
    vec3 share = vec3(lit_past_outline(light, video_here, covered, matters));
#ifdef LIT_GROUND
    vec4 lit = texture(lit_ground, (ground - lit_bounds.xy) / (lit_bounds.zw - lit_bounds.xy));
    vec3 seen = clamp(video_here / max(lit.rgb, 1e-4), OVERSHOOT.x * shadow_ratio, vec3(OVERSHOOT.y));
    vec3 measured = (seen - shadow_ratio) / max(1.0 - shadow_ratio, 1e-3);
    share = mix(share, measured, matters && covered == 0.0 ? lit.a : 0.0);
#endif
    return share;
}
#endif

// Length of the horizontal part of the mean direction, weighted by cosine, of the half of the sky hidden at a wall's foot.
const float WALL = 0.4244;  // 4 / (3 pi)

void main() {
    vec2 at = (ground_placed - patch_bounds.xy) / (patch_bounds.zw - patch_bounds.xy);
    float covered = 0.0;
    float reaching = 1.0;  // of the lights, what no shadow has taken that has come onto the sheet
#ifdef COVERS
    covered = cover_at(ground).a;
    float sky_share = dot(sky, LUMINANCE);
    float level_now = exp(min(over_sheet_at(ground).g, 0.0));
    reaching = mix(1.0, clamp((level_now - sky_share) / max(1.0 - sky_share, 1e-3), 0.0, 1.0), covered);
#endif
    // What hides the sky on one side only is a wall; what hides it evenly hangs above. Most places are in between.
    vec4 contact_here = texture(contact, at);
    vec3 hidden = contact_here.rgb;
    float shaded = 0.0;  // fraction blocked of the light that the model blocks most
    float is_wall = min(length(hidden.yz) / max(WALL * hidden.x, 1e-4), 1.0);
    vec2 outward_placed = normalize(-hidden.yz + vec2(1e-9, 0.0));
    vec2 outward = normalize((marker_from_placed * vec4(outward_placed, 0.0, 0.0)).xy);
    vec3 on_walls = vec3(0.0);  // light of the lights on these walls
    vec3 before = sky;
    vec3 after = sky;
#if LIGHTS > 0
    vec2 columns = dFdx(ground), rows = dFdy(ground);
    float texel_m = TEXEL_SIDES * sqrt(abs(columns.x * rows.y - columns.y * rows.x));
    for (int light = 0; light < LIGHTS; ++light) {
        float falloff;
        vec3 towards = towards_light(light, vec3(ground, 0.0), falloff);
#ifdef SOFT_BORDER
        // Four taps at these offsets blur by a standard deviation of border_px along both axes.
        vec2 across = border_px * dFdx(ground), along = border_px * dFdy(ground);
        float lit = 0.25 * (lit_past_models(light, ground + across + along) + lit_past_models(light, ground + across - along)
            + lit_past_models(light, ground - across + along) + lit_past_models(light, ground - across - along));
#else
        float lit = lit_around_models(light, ground, texel_m);
#endif
        vec3 seen = light_ground_share[light] * ground_falloff(light, ground);
        vec3 share = vec3(1.0);
#if CASTERS > GROUPS
        share = lit_past_real(light, covered, max(hidden.x * contact_here.a, 1.0 - lit) > MATTERS);
#endif
        share *= reaching;
        seen *= share;
        before += seen;
        after += seen * lit;
        shaded = max(shaded, 1.0 - lit);
        // A shadow that reaches a wall on the ground continues up the wall.
        on_walls += light_irradiance[light] * (falloff * share * lit * max(dot(outward, towards.xy), 0.0));
    }
#endif
    vec3 from_ground = ground_bounce * after / max(before, 1e-3);
    vec3 unshaded = before;  // by models
#ifdef CONTACT_ALONE
    // The picture below already has all shadows and another model's contact.
    before = after;
#endif
    hidden *= mix(contact_here.a, 1.0, shaded);
    // Where the sky is hidden, the ground sees the model instead: an underside lit by the ground, or a wall lit by the
    // ground, the lights and half of the sky.
    vec3 on_wall = 0.5 * (sky + texture(walls, at).rgb) + on_walls;
    vec3 facing = model_albedo * mix(from_ground, on_wall, is_wall);
    // A sky whose radiance increases by k times the x of its direction gives a wall that faces x a third of k more.
    vec2 hidden_from = (marker_from_placed * vec4(hidden.yz, 0.0, 0.0)).xy;
    hidden_from *= length(hidden.yz) / max(length(hidden_from), 1e-6);
    vec3 gone = hidden.x * sky + 3.0 * (sky_slope[0] * hidden_from.x + sky_slope[1] * hidden_from.y);
    vec3 of_sky = hidden.x * facing - max(gone, 0.0);
    after += of_sky;
    vec3 ratio = mix(vec3(1.0), after / max(before, 1e-3), strength);
    vec3 change = abs(1.0 - ratio);
    bool is_counted = false;
#if LIGHTS > 0 && CASTERS > GROUPS && !defined(CONTACT_ALONE)
    // Where both shadows lie the model takes nothing; but beside that it counts how little there is to take.
    is_counted = shaded > MATTERS;
#endif
    if (!is_counted && covered == 0.0 && max(change.r, max(change.g, change.b)) < 0.0005) discard;
    added_light = vec4(0.0);
#ifdef COVERS
    added_light.a = COVER_ALPHA * covered;
#endif
#ifdef CONTACT_ALONE
    removed = vec4(1.0 - ratio, SAME_GROUND);
#else
    float left = dot(sky + of_sky, LUMINANCE);  // without any of the lights
    removed = vec4(1.0 - ratio, number_of_ground(1.0 - left / max(dot(unshaded, LUMINANCE), 1e-3)));
#endif
}
