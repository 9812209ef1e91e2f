// The fraction of a light that reaches a point, from shadow maps: one tile of a shared texture per caster and light.
// LIGHTS may be 0. LAMPS is 1 if any light is near by. The first GROUPS of CASTERS are the models, which are one group but
// where a lamp stands among them; one more, if any, is the real object.
//
// With BLOCKER_TAPS 0, percentage-closer filtering with PCF_RADIUS >= 1 (Reeves, Salesin, Cook, "Rendering antialiased
// shadows with depth maps", SIGGRAPH 1987). Otherwise percentage-closer soft shadows with SOFT_TAPS over the penumbra
// (Fernando, SIGGRAPH 2005). Rays are parallel in a map's coordinates, also those of a lamp (render/lights/light_view.py),
// so that the blocker search covers the disc of the light as seen from the receiver. DITHERED is defined where a caster is
// clear in part, so that only some of its texels stop the light (depth.frag). With OVER_PIXELS, what is not the caster itself
// gets the mean over the area of its pixel as well, where that is larger than a texel: borders there would be staircases.
#if LIGHTS > 0
#define MAPS (LIGHTS * CASTERS)

uniform sampler2DShadow shadow_maps;  // compares and interpolates between four texels
uniform sampler2D shadow_depths;  // the same texture, without comparison
uniform vec2 shadow_texture_size;  // texels
uniform float shadow_map_size;  // texels a side of a tile
uniform vec2 shadow_tile[MAPS];  // lower left corners, texels
uniform mat4 shadow_from_marker[MAPS];  // to a tile's coordinates and depth, all in [0, 1]; projective for a lamp
#if LAMPS
uniform mat4 shadow_planes_from_marker[MAPS];  // the same for planes, given as (normal, offset)
#endif
uniform vec3 shadow_extent[MAPS];  // size in metres of a tile's coordinates and depth
uniform float tan_half_size[MAPS];  // the light's radius over its distance from the caster

// Of a surface that is its own caster: the depth per texel up to which its slope is followed, how far from a tap the texels are
// with which that is compared, and how far a point is moved towards the light for these at most; all in texels.
const float STEEPEST = 30.0, FARTHEST_TEXEL = 1.42, MOST_AHEAD = 1.0;

// Of a receiver: the depth by which its plane changes per texel aside, and by how much more than that a blocker of a wide light
// stands out, over how far aside it is.
struct Receiver {
    vec2 slope;
    float least_rise;
    mat2 pixel;  // the sides of what a pixel shows of it, texels; counts only with OVER_PIXELS
};
const Receiver NOT_IN_MAP = Receiver(vec2(0.0), 0.0, mat2(0.0));
// Hollow surfaces rise from their plane to all sides, the more, the more light grazes them (LEAST_RISE, and RISE_OF_SLOPE of
// the slope), and block nothing: of a light of the radius r at a distance of 1, only what stands out by 1 / r of how far
// aside it is takes any. No more than MOST_RISE of that is asked for. Chosen on a bowl and a mug (docs/rendering/shadows.md).
// With ALL_BLOCK nothing of it is asked for: of light from all around, what rises from a plane does take a share.
const float LEAST_RISE = 1.0, RISE_OF_SLOPE = 0.7, MOST_RISE = 0.9;

// From a tile's texels to texture coordinates. The tile's border is empty, so clamping leaves points beyond it lit.
vec2 in_texture(int map, vec2 texel) {
    return (shadow_tile[map] + clamp(texel, 0.5, shadow_map_size - 0.5)) / shadow_texture_size;
}

#if BLOCKER_TAPS > 0
#ifdef OVER_PIXELS
#define Spread mat2
// From the unit disc to one of `radius` texels or, with OVER_PIXELS, to an ellipse that has the variance of that and of the
// pixel together: of a disc it is a quarter along both axes, of a parallelogram a twelfth.
mat2 spread(vec2 radius, Receiver receiver) {
    mat2 both = mat2(radius.x * radius.x, 0.0, 0.0, radius.y * radius.y) + receiver.pixel * transpose(receiver.pixel) / 3.0;
    // The root of a symmetric matrix without negative eigenvalues.
    float root = sqrt(max(determinant(both), 0.0));
    return (both + mat2(root)) / sqrt(both[0][0] + both[1][1] + 2.0 * root);
}
#else
#define Spread vec2
vec2 spread(vec2 radius, Receiver receiver) {
    return radius;
}
#endif

// Golden-angle spiral: points at radii of the square roots of equal steps are spread evenly over a disc (Vogel 1979).
const mat2 GOLDEN_TURN = mat2(-0.73736888, 0.67549029, -0.67549029, -0.73736888);
// Texels, of a penumbra: a texel's own, or as much as averages a pattern that repeats itself every four texels.
#ifdef DITHERED
const float LEAST_RADIUS = 2.75;
#else
const float LEAST_RADIUS = 0.75;
#endif

// Of a map's side: of a disc with a larger radius few samples may miss what covers a part of it.
const float MOST_SEEN = 0.02;
const bool ARE_FEW = BLOCKER_TAPS < 16;

// A direction on the half circle that differs from texel to texel, to turn banding into noise that stays fixed to the
// receiver (interleaved gradient noise, Jimenez 2014).
vec2 first_ray(vec2 texel) {
    float t = 2.0 * fract(52.9829189 * fract(dot(floor(texel), vec2(0.06711056, 0.00583715)))) - 1.0;
    return vec2(1.0 - t * t, 2.0 * t) / (1.0 + t * t);
}

// How much of a light's disc, as seen from a receiver, a caster covers, and how wide a penumbra that makes.
struct Blockers {
    float share;  // of the samples
    bool is_wide;  // whether they may have missed what covers a part of it
    float radius_m;  // of the penumbra across the light, where they are neither none nor all
};

Blockers blockers_of(int map, float tan_half, vec3 at, Receiver receiver, vec2 ray) {
    vec2 texels_per_m = shadow_map_size / shadow_extent[map].xy;
    vec2 centre = at.xy * shadow_map_size;
    vec2 search = max(vec2(1.5), at.z * shadow_extent[map].z * tan_half * texels_per_m);
    float least_rise = receiver.least_rise * at.z * tan_half;  // at the rim of what is searched
    Spread searched = spread(search, receiver);
    vec2 farthest = search + abs(receiver.pixel[0]) + abs(receiver.pixel[1]);
    bool is_near = all(lessThan(abs(centre - 0.5 * shadow_map_size), 0.5 * shadow_map_size + farthest));
    float depths = 0.0;
    float blockers = 0.0;
    // A software rasteriser saves time when a loop ends early, but not when a branch is not taken.
    for (int k = 0; k < (is_near ? BLOCKER_TAPS : 0); ++k) {
        float away = sqrt((float(k) + 0.5) / float(BLOCKER_TAPS));
        vec2 aside = searched * (ray * away);
        float depth = texture(shadow_depths, in_texture(map, centre + aside)).r;
        float blocks = step(depth, min(at.z + dot(receiver.slope, aside) - least_rise * away, 0.99999));
        depths += blocks * depth;
        blockers += blocks;
        ray = GOLDEN_TURN * ray;
    }
    float distance = (at.z - depths / max(blockers, 1.0)) * shadow_extent[map].z;
    bool is_wide = ARE_FEW && search.x > MOST_SEEN * shadow_map_size;
    return Blockers(blockers / float(BLOCKER_TAPS), is_wide, distance * tan_half);
}

bool is_penumbra(Blockers blockers) {
#ifdef DITHERED
    return true;  // as of a wide disc
#else
    return blockers.is_wide || (blockers.share > 0.0 && blockers.share < 1.0);
#endif
}

// The mean over a penumbra of `radius` texels.
float lit_fraction(int map, vec3 at, Receiver receiver, vec2 ray, Blockers blockers, vec2 radius) {
    vec2 centre = at.xy * shadow_map_size;
    float least_rise = receiver.least_rise * blockers.radius_m / shadow_extent[map].z;
    Spread averaged = spread(radius, receiver);
    float lit = 0.0;
    for (int k = 0; k < (is_penumbra(blockers) ? SOFT_TAPS : 0); ++k) {
        float away = sqrt((float(k) + 0.5) / float(SOFT_TAPS));
        vec2 aside = averaged * (ray * away);
#ifdef DITHERED
        // Between four texels, so that four taps in a row see each of the pattern's sixteen texels once.
        vec2 between = vec2(k & 2, k << 1 & 2);
        aside = between + 4.0 * round(0.25 * (centre + aside - between)) - centre;
#endif
        float depth = clamp(at.z + dot(receiver.slope, aside) - least_rise * away, 0.0, 1.0);
        lit += texture(shadow_maps, vec3(in_texture(map, centre + aside), depth));
        ray = GOLDEN_TURN * ray;
    }
    return is_penumbra(blockers) ? lit / float(SOFT_TAPS) : 1.0 - step(0.5, blockers.share);
}

float lit_fraction(int map, float tan_half, vec3 at, Receiver receiver) {
    vec2 ray = first_ray(at.xy * shadow_map_size);
    Blockers blockers = blockers_of(map, tan_half, at, receiver, ray);
    vec2 radius = max(vec2(LEAST_RADIUS), blockers.radius_m * shadow_map_size / shadow_extent[map].xy);
    return lit_fraction(map, at, receiver, ray, blockers, radius);
}
#else
#ifdef OVER_PIXELS
// Taps spread over a pixel, sixteenths of its sides: no two of them are in one row, in one column, or on one line of 45 degrees.
const int TAPS_IN_PIXEL = 8;
const vec2 IN_PIXEL[TAPS_IN_PIXEL] = vec2[](
    vec2(1, -3), vec2(-1, 3), vec2(5, 1), vec2(-3, -5), vec2(-5, 5), vec2(-7, -1), vec2(3, 7), vec2(7, -7)
);

// Of what is not in the map.
float lit_fraction(int map, float tan_half, vec3 at, Receiver receiver) {
    mat2 sides = receiver.pixel;
    for (int side = 0; side < 2; ++side) {
        sides[side] *= max(float(2 * PCF_RADIUS + 1) / max(length(sides[side]), 1e-6), 1.0);
    }
    float lit = 0.0;
    for (int k = 0; k < TAPS_IN_PIXEL; ++k) {
        vec2 texel = at.xy * shadow_map_size + sides * IN_PIXEL[k] / 16.0;
        lit += texture(shadow_maps, vec3(in_texture(map, texel), clamp(at.z, 0.0, 1.0)));
    }
    return lit / float(TAPS_IN_PIXEL);
}
#else
// Along one axis, 2 r + 1 bilinear taps weight 2 r + 2 texels by 1-f, 1, ..., 1, f. One bilinear tap placed between two
// texels can weight both, so (r + 1)^2 taps give exactly the result of (2 r + 1)^2.
// Returns the weight of pair k and the tap's offset from the pair's first texel.
vec2 tap_pair(int k, float f) {
    return k == 0 ? vec2(2.0 - f, 1.0 / (2.0 - f)) : k == PCF_RADIUS ? vec2(1.0 + f, f / (1.0 + f)) : vec2(2.0, 0.5);
}

float lit_fraction(int map, float tan_half, vec3 at, Receiver receiver) {
    vec2 texels = at.xy * shadow_map_size - 0.5;
    vec2 first = floor(texels);
    vec2 f = texels - first;
    float lit = 0.0;
    for (int row = 0; row <= PCF_RADIUS; ++row) {
        vec2 y = tap_pair(row, f.y);
        for (int column = 0; column <= PCF_RADIUS; ++column) {
            vec2 x = tap_pair(column, f.x);
            vec2 aside = vec2(2 * column, 2 * row) - float(PCF_RADIUS) + vec2(x.y, y.y);
            float depth = clamp(at.z + dot(receiver.slope, aside - f), 0.0, 1.0);
            lit += x.x * y.x * texture(shadow_maps, vec3(in_texture(map, first + aside + 0.5), depth));
        }
    }
    return lit / float((2 * PCF_RADIUS + 1) * (2 * PCF_RADIUS + 1));
}
#endif
#endif

// A point's coordinates and depth in a map. `scale`: how much larger a texel is at the point than at the caster.
vec3 in_map(int map, vec3 position, out float scale) {
    vec4 at = shadow_from_marker[map] * vec4(position, 1.0);
#if LAMPS
    // The caster is in front of the lamp: what is beside or behind it is beside the map, where no blocker is looked for.
    const float LEAST_SCALE = 1e-3;
    scale = max(at.w, LEAST_SCALE);
    return at.w < LEAST_SCALE ? vec3(-1.0) : at.xyz / scale;
#else
    scale = 1.0;
    return at.xyz;
#endif
}

// The fraction of a light that a caster lets through to a point that is not part of it.
float lit_past(int caster, int light, vec3 position) {
    int map = caster * LIGHTS + light;
    float scale;
    // The map's depth range ends behind the caster but the ground goes on: lit_fraction clamps points beyond the range.
    vec3 at = in_map(map, position, scale);
    Receiver receiver = NOT_IN_MAP;
#ifdef OVER_PIXELS
    receiver.pixel = shadow_map_size * mat2(dFdx(at.xy), dFdy(at.xy));
#endif
    return lit_fraction(map, tan_half_size[map], at, receiver);
}

// The same for all models together.
float lit_past_models(int light, vec3 position) {
    float lit = 1.0;
    for (int group = 0; group < GROUPS; ++group) lit *= lit_past(group, light, position);
    return lit;
}

// The same for a point on the caster's own surface. `normal` is on the light's side, `to_light` the direction to the light.
float lit_past_itself(int caster, int light, vec3 position, vec3 normal, vec3 to_light) {
    int map = caster * LIGHTS + light;
    vec3 extent = shadow_extent[map];
    float scale;
    vec3 at = in_map(map, position, scale);
    float texel = scale * max(extent.x, extent.y) / shadow_map_size;
    float cosine = dot(normal, to_light);
    float tangent = sqrt(max(1.0 / max(cosine * cosine, 1e-6) - 1.0, 0.0));
    // On a plane at an angle theta to the light, a tap at a distance t finds a depth that differs by t tan(theta): taps follow
    // the plane's slope (depth per texel). What is left are the texels around a tap. For them the point is moved towards the
    // light, which moves no shadow aside, but past what stands near by where light grazes: from there on along its normal, by
    // a distance of which 1 / cos(theta) counts. Half a texel covers rounding and curvature.
    float ahead = min(FARTHEST_TEXEL * tangent, MOST_AHEAD);
    float above = (FARTHEST_TEXEL * tangent - ahead) * cosine;
#if LAMPS
    vec3 facing = (shadow_planes_from_marker[map] * vec4(normal, -dot(normal, position))).xyz;
    vec2 slope = facing.xy / max(-facing.z, 1e-6);
    at = in_map(map, position + texel * (above * normal + (ahead + 0.5) * to_light), scale);
#else
    vec3 along = mat3(shadow_from_marker[map]) * normal;
    vec2 slope = along.xy * extent.xy * extent.xy / max(cosine * extent.z, 1e-6);
    at += texel * vec3(above * along.xy, above * along.z - (ahead + 0.5) / extent.z);
#endif
    float steepest = STEEPEST * texel / (scale * scale * extent.z);
    slope = clamp(slope / shadow_map_size, -steepest, steepest);
#ifdef ALL_BLOCK
    float rise = 0.0;
#else
    float rise = max(min(RISE_OF_SLOPE * tangent, MOST_RISE / tan_half_size[map]), LEAST_RISE);
#endif
    return lit_fraction(map, tan_half_size[map], at, Receiver(slope, rise, mat2(0.0)));
}

// The fraction of a light that reaches a point on a model. Of which group it is makes no difference worth a uniform.
float shadow(int light, vec3 position, vec3 normal, vec3 to_light) {
    float lit = 1.0;
    for (int group = 0; group < GROUPS; ++group) lit *= lit_past_itself(group, light, position, normal, to_light);
#if CASTERS > GROUPS
    lit *= lit_past(GROUPS, light, position);
#endif
    return lit;
}
#endif
