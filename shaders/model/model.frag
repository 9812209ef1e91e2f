// A surface lit by the sky, the scene's lights, and light reflected from the ground, in linear light.
// Each macro switches on a feature of the material or the scene.
#version 330 core
#include "lights/lights.glsl"
#include "lights/shadow.glsl"
#include "lights/ground_shadow.glsl"

uniform vec4 base_colour;
uniform vec3 sky;  // irradiance on level ground over pi, linear RGB
uniform vec3 sky_slope[2];  // what surfaces facing x and y get beyond the light of an even sky
uniform vec3 ground_bounce;
uniform vec3 eye;  // metres, marker frame
uniform vec3 exposure;  // value in the picture of a radiance of 1
#if LIGHTS > 0
uniform vec3 light_irradiance[LIGHTS];  // irradiance over pi across the light's direction
#endif
uniform float metallic;
uniform float roughness;
uniform float coat;  // share of the surface that lies under a clear coat
uniform float coat_roughness;
uniform float normal_scale;
uniform float occlusion_strength;
uniform vec3 emissive;
uniform float alpha_cutoff;
uniform float part_number;  // by which surfaces of different parts differ

#ifdef GLOSSY
#include "model/brdf.glsl"
#endif
#include "model/glass.glsl"
#include "model/environment.glsl"
#include "model/triangle.glsl"

in vec3 position;
// Interpolated at the centroid of the covered part of the pixel: beyond the triangle's border they would be extrapolated,
// and thin triangles would sparkle. Positions are interpolated at the pixel's middle. There they are extrapolated along
// the triangle's plane, which does no harm; at the centroid, Mesa would divide them by the middle's depth, which takes
// them off their surface.
centroid in vec3 normal;
centroid in vec4 openness;  // shares of sky and ground that the model leaves open, in front of the surface and behind it
#include "model/layout.glsl"
#ifdef VERTEX_COLOURS
centroid in vec4 colour;
#endif
#ifdef BASE_MAP
uniform sampler2D base_map;  // decoded to linear by the sampler, as is the emissive map
#endif
#ifdef METALLIC_ROUGHNESS_MAP
uniform sampler2D metallic_roughness_map;
#endif
#ifdef NORMAL_MAP
uniform sampler2D normal_map;
#endif
#ifdef OCCLUSION_MAP
uniform sampler2D occlusion_map;
#endif
#ifdef EMISSIVE_MAP
uniform sampler2D emissive_map;
#endif
layout(location = 0) out vec4 added_light;  // premultiplied; alpha: coverage
layout(location = 1) out vec4 removed;  // fraction taken of the light from behind; alpha: see number_of_surface

vec3 smooth_normal() {
    return normalize(gl_FrontFacing ? normal : -normal);
}

#ifdef ROUNDED
in vec3 tangent_planes[2];
in vec3 at_tangent_planes;

// Cosines of the angle between a triangle and its smooth normal, from which on, and up to which, it stands for a round surface.
const float NOT_ROUND = 0.80, ROUND = 0.92;

// How far the round surface lies above the triangle that stands for it: the mean of the distances to its vertices' tangent
// planes, by their shares of this point (Hanika, "Hacking the shadow terminator", Ray Tracing Gems II, 2021).
vec3 above_triangle(vec3 facing) {
    mat3 planes = mat3(
        tangent_planes[0],
        vec3(tangent_planes[0].y, tangent_planes[1].xy),
        vec3(tangent_planes[0].z, tangent_planes[1].yz)
    );
    vec3 above = at_tangent_planes - planes * position;
    return dot(above, facing) > 0.0 ? above : vec3(0.0);
}
#endif

vec3 surface_normal() {
    vec3 n = smooth_normal();
#ifdef NORMAL_MAP
    // The directions in which u and v grow, from screen-space derivatives: Schueler, "Followup: normal mapping without
    // precomputed tangents", 2013. As glTF asks (MikkTSpace), both axes of the tangent frame are unit vectors, however much
    // the map is stretched, and the first is along lines of the same v.
    vec3 across = cross(dFdy(position), n);
    vec3 along = cross(n, dFdx(position));
    vec2 du = dFdx(laid_out(NORMAL));
    vec2 dv = dFdy(laid_out(NORMAL));
    vec3 u_grows = across * du.x + along * dv.x;
    vec3 v_grows = across * du.y + along * dv.y;
    vec3 bump = texture(normal_map, laid_out(NORMAL)).xyz * (255.0 / 127.0) - (128.0 / 127.0);
    if (dot(v_grows, v_grows) > 0.0) {
        vec3 bitangent = normalize(v_grows);
        vec3 tangent = cross(bitangent, n);
        vec2 slope = bump.xy * normal_scale * vec2(sign(dot(tangent, u_grows)), 1.0);
        n = normalize(tangent * slope.x + bitangent * slope.y + n * max(bump.z, 0.05));
    }
#endif
    return n;
}

// In heights of the point on the wall: the middle of the nearer two THIRDS together, and how far they reach on both sides.
const float NEARER = 1.2;
const float NEARER_WIDTH = 1.5;

// Light, over pi, that a wall facing `direction` gets from the ground with the model's shadow on it. `unshaded`: without it.
vec3 from_ground(vec3 direction, out vec3 unshaded) {
    float height = max(position.z, 0.0);
    vec2 away = height * direction.xy;
    // The ground near by has the colours of the picture there: the marker's paper is brighter than what it lies on.
    vec3 near = ground_seen(position.xy + NEARER * away, NEARER_WIDTH * height) / 3.0;
    vec3 far = ground_bounce / 3.0;
    unshaded = 2.0 * near + far;
    vec3 left = left_on_ground(position.xy + THIRDS[0] * away, WIDTHS[0] * height);
    left += left_on_ground(position.xy + THIRDS[1] * away, WIDTHS[1] * height);
    return near * left + far * light_on_ground(position.xy + THIRDS[2] * away, WIDTHS[2] * height);
}

// Light, over pi, on a surface facing `direction` (or the radiance from it): of the sky above and the `ground` below, as far
// as they are `open`.
vec3 ambient(vec3 direction, vec2 open, vec3 ground) {
    float upward = 0.5 + 0.5 * direction.z;
    vec3 from_sky = sky * upward + sky_slope[0] * direction.x + sky_slope[1] * direction.y;
    return max(from_sky, 0.0) * open.x + ground * ((1.0 - upward) * open.y);
}

#ifdef GLOSSY
#ifdef MIRRORS
#define AROUND(towards, rough) surrounding_radiance(position, towards, (rough) * (rough))
#else
#define AROUND(towards, rough) ambient(towards, vec2(1.0), unshaded * left_towards(towards))

// Surfaces with faint, rough reflections look the shadow up only once, in the middle of the nearer two THIRDS.
vec3 left_towards(vec3 towards) {
    float height = max(position.z, 0.0);
    return left_on_ground(position.xy + NEARER * height * towards.xy, NEARER_WIDTH * height);
}
#endif

// The mirrored direction. An interpolated or mapped normal may mirror what lies below the triangle, which faces `facing`. Then
// it is the lowest direction that does not, and `n` becomes the normal that mirrors this one.
vec3 mirrored_direction(vec3 to_eye, vec3 facing, inout vec3 n) {
    vec3 mirror = reflect(-to_eye, n);
    float above = dot(mirror, facing);
    if (above < 0.0) {
        mirror = normalize(mirror - above * facing);
        n = normalize(to_eye + mirror);
    }
    return mirror;
}

// The open share of the lobe around the mirrored direction: Lagarde, de Rousiers, "Moving Frostbite to PBR", 2014.
float open_lobe(vec2 open, vec3 mirror, float rough, float n_v) {
    float ahead = mix(open.y, open.x, 0.5 + 0.5 * mirror.z);
    return clamp(pow(n_v + ahead, exp2(-16.0 * rough - 1.0)) - 1.0 + ahead, 0.0, 1.0);
}
#endif

// A number by which outlines.frag distinguishes edges between surfaces, and borders of shadows, from what is painted on a
// surface. It is the same wherever the part, the plane of the triangle and the light that comes `through` are the same, and
// hardly ever elsewhere.
float number_of_surface(vec3 facing, float through) {
    float plane = dot(facing, vec3(0.32, 0.44, 0.27)) + dot(facing, position - eye) * inversesqrt(dot(eye, eye));
    return plane + part_number + 0.04 * through;
}

const float ANYHOW = 0.25;  // mean of the clamped cosine over surfaces that face anywhere
const float MOST_ALBEDO = 0.9;  // of real surfaces
// The layers' half precision ends at 65504. Beyond it they would be infinite, and blurring makes 0 * infinity undefined.
const float MOST_LIGHT = 1e4;
#ifdef CUT_OUT
const float LEAST_ALPHA = 1.0 / 255.0;
#endif
#ifdef BLEND
const float LEAST_GLASS = 5.0 / 255.0;  // alpha from which on a surface mirrors as glass does
#endif

void main() {
    vec4 base = base_colour;
#ifdef VERTEX_COLOURS
    base *= colour;
#endif
#ifdef BASE_MAP
    base *= texture(base_map, laid_out(BASE), -0.5);
#endif
#ifdef CUT_OUT
    // The part of the pixel that is not cut away: the distance to where alpha crosses the cut-off, in pixels. All that has
    // the cut-off's own alpha is kept, and nothing that has a step less.
    float above = base.a - alpha_cutoff + 0.5 * LEAST_ALPHA;
    float kept = above / max(length(vec2(dFdx(base.a), dFdy(base.a))), LEAST_ALPHA) + 0.5;
#endif
    vec3 n = surface_normal();
    vec3 facing = triangle_normal(position, n);
    vec2 open = gl_FrontFacing ? openness.xy : openness.zw;
    float hidden = 1.0 - mix(open.y, open.x, 0.5 + 0.5 * n.z);
#ifdef OCCLUSION_MAP
    // The map says the same of the same parts in finer detail; taking the product would count the occlusion twice.
    open = min(open, 1.0 + occlusion_strength * (texture(occlusion_map, laid_out(OCCLUSION)).r - 1.0));
#endif
    // An interpolated or mapped normal may lean away from the triangle, from below which no light comes. Of the
    // cosine-weighted hemisphere around n, the share (1 + n.facing) / 2 is above the triangle as well.
    vec3 unshaded;
    vec3 ground = from_ground(n, unshaded);
    vec3 from_around = ambient(n, open, ground) * (0.5 + 0.5 * dot(n, facing));
    vec3 from_lights = vec3(0.0);
    float through = 0.0;  // sum over the lights of the fractions that arrive
    vec3 diffuse = from_around;
    vec3 mirrored = vec3(0.0);
    vec3 albedo = base.rgb;
#ifdef GLOSSY
    float metal = metallic;
    float rough = roughness;
#ifdef METALLIC_ROUGHNESS_MAP
    vec2 mapped = texture(metallic_roughness_map, laid_out(METALLIC_ROUGHNESS)).bg;
    metal *= mapped.x;
    rough *= mapped.y;
#endif
    rough = max(rough, MIN_ROUGHNESS);
    vec3 f0 = mix(vec3(GLASS), base.rgb, metal);
    albedo *= 1.0 - metal;
    vec3 to_eye = normalize(eye - position);
    vec3 shine_n = n;
    vec3 mirror = mirrored_direction(to_eye, facing, shine_n);
    float n_v = max(dot(shine_n, to_eye), 1e-3);
    Facets facets = facets_in_pixel(rough, n, n_v);
    vec3 share = mirrored_share(rough, n_v);
    vec3 compensation = energy_compensation(f0, share);
    // What is mirrored does not reach the diffuse layer.
    vec3 reflectance = (f0 * share.x + share.y) * compensation;
    albedo *= 1.0 - max(reflectance.r, max(reflectance.g, reflectance.b));
#endif
#ifdef COATED
    // KHR_materials_clearcoat: a smooth layer of glass over the normal map.
    vec3 coat_n = smooth_normal();
    vec3 coat_mirror = mirrored_direction(to_eye, facing, coat_n);
    float coat_rough = max(coat_roughness, MIN_ROUGHNESS);
    float coat_n_v = max(dot(coat_n, to_eye), 1e-3);
    Facets coat_facets = facets_in_pixel(coat_rough, coat_n, coat_n_v);
    vec3 coat_share = mirrored_share(coat_rough, coat_n_v);
    float coat_reflectance = GLASS * coat_share.x + coat_share.y;
    vec3 in_coat = vec3(0.0);
#endif
#if LIGHTS > 0
    // Triangles that stand for a round surface are lit and shaded as that is: otherwise the light would end on their edges.
    vec3 surface = facing;
    vec3 on_surface = position;
#ifdef ROUNDED
    float roundness = smoothstep(NOT_ROUND, ROUND, dot(facing, smooth_normal()));
    surface = normalize(mix(facing, smooth_normal(), roundness));
    on_surface += roundness * above_triangle(facing);
    mat2x3 turns = mat2x3(dFdx(n), dFdy(n)), moves = mat2x3(dFdx(position), dFdy(position));
#endif
    for (int light = 0; light < LIGHTS; ++light) {
        float falloff;
        vec3 to_light = towards_light(light, position, falloff);
        from_lights += light_irradiance[light] * falloff;
        float cosine = dot(n, to_light);
        float lit_share = 1.0;  // of the pixel that faces the light
        vec3 lit_at = on_surface;
        vec3 lit_surface = surface;
#ifdef ROUNDED
        // Of a pixel in which the light ends, as on a thin rim, the part is drawn that the light sees: by its share, the mean
        // of its cosines, and the shadow in its middle. By the pixel's middle alone, lit and unlit ones would take turns.
        vec2 grows = to_light * turns;
        float spread = 0.5 * (abs(grows.x) + abs(grows.y));
        if (abs(cosine) < spread) {
            lit_share = 0.5 + 0.5 * cosine / spread;
            vec2 aside = grows * ((lit_share * spread - cosine) / dot(grows, grows));
            cosine = lit_share * spread;
            lit_at += moves * aside;
            lit_surface = normalize(surface + roundness * (turns * aside));
        }
#endif
        cosine = max(cosine, 0.0);
#ifdef COATED
        float coat_cosine = max(dot(coat_n, to_light), 0.0);
        if (max(cosine, coat_cosine) <= 0.0) continue;
#else
        if (cosine <= 0.0) continue;
#endif
        if (dot(lit_surface, to_light) <= 0.0) continue;
        float lit = shadow(light, lit_at, lit_surface, to_light);
        through += lit * lit_share;
        vec3 arrives = light_irradiance[light] * (falloff * lit);
        diffuse += arrives * (lit_share * cosine);
#ifdef GLOSSY
        vec3 between = normalize(to_eye + to_light);
        float v_h = max(dot(to_eye, between), 0.0);
        float n_l = max(lit_share < 1.0 ? cosine : dot(shine_n, to_light), 1e-3);
        vec3 shine = ggx(facets, shine_n, between, n_v, n_l, v_h, tan_half_size[light]) * fresnel(f0, v_h);
        mirrored += arrives * n_l * compensation * shine;
#ifdef COATED
        float coat_shine = ggx(coat_facets, coat_n, between, coat_n_v, coat_cosine, v_h, tan_half_size[light]);
        in_coat += arrives * coat_cosine * coat_shine * fresnel(vec3(GLASS), v_h);
#endif
#endif
    }
#endif
    // Where the model hides sky and ground from itself, it shows itself instead. These parts are taken to have the colour of
    // this place, and the same light from sky and ground; from the lights they get what a surface facing anywhere gets that
    // sees as much of the sky. Interreflections sum up to a geometric series (the fit for grey cavities of Jimenez, Wu,
    // Pesce, Jarabo, "Practical realtime strategies for accurate indirect occlusion", 2016).
    vec3 thrown = hidden * min(base.rgb, MOST_ALBEDO);
    vec3 on_parts = (from_around + ANYHOW * open.x * from_lights) / (1.0 - thrown);
    diffuse += thrown * on_parts;
#ifdef GLOSSY
    mirrored += mix(base.rgb * on_parts, AROUND(mirror, rough), open_lobe(open, mirror, rough, n_v)) * reflectance;
#endif
#ifdef COATED
    float coat_open = open_lobe(open, coat_mirror, coat_rough, coat_n_v);
    in_coat += mix(base.rgb * on_parts, AROUND(coat_mirror, coat_rough), coat_open) * coat_reflectance;
    float below_coat = 1.0 - coat * coat_reflectance;
    diffuse *= below_coat;
    mirrored = mirrored * below_coat + in_coat * coat;
#endif
    vec3 emitted = vec3(0.0);
#ifdef EMITS
    emitted = emissive;
#ifdef EMISSIVE_MAP
    emitted *= texture(emissive_map, laid_out(EMISSIVE)).rgb;
#endif
#if defined(UNLIT) && defined(VERTEX_COLOURS)
    emitted *= colour.rgb;
#endif
#endif
#ifdef BLEND
    float cover = base.a;
#ifdef GLOSSY
    // Reflected light hides what is behind the surface.
    vec3 reflected = f0 * share.x + share.y;
    cover += (1.0 - cover) * min(max(reflected.r, max(reflected.g, reflected.b)), 1.0);
#endif
#ifdef COATED
    cover += (1.0 - cover) * coat * coat_reflectance;
#endif
    // Where nothing is drawn there is a hole, and no glass.
    float there = min(base.a / LEAST_GLASS, 1.0);
    if (there <= 0.0) discard;
#ifdef SOLID
#ifdef IS_SOLID
    if (base.a < SOLID) discard;
#else
    if (base.a >= SOLID) discard;
#endif
#endif
    added_light = vec4(min(((albedo * diffuse + emitted) * base.a + mirrored) * exposure, MOST_LIGHT), cover) * there;
    removed = vec4(cover * there);
#else
    added_light = vec4(min((albedo * diffuse + emitted + mirrored) * exposure, MOST_LIGHT), 1.0);
    // Not before what is derived from neighbouring pixels, which they would be missing in.
#ifdef RIM
    if (kept <= 0.0 || kept >= 1.0) discard;
    added_light *= kept;
    removed = vec4(kept);
#else
#ifdef CUT_OUT
    if (kept < 1.0) discard;
#endif
    removed = vec4(vec3(1.0), number_of_surface(facing, through));
#endif
#endif
}
