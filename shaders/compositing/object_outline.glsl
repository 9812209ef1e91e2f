// How the layers are blurred across the real object's outline, where the video has a border that is blurred already.
//
// Of the light U of a scene a camera shows v = G U, and of the same scene with what the layers g and a are of it
// G (U (1 - g) + a). Beside the outline U is one value B on the ground (or whatever is behind the object) and another one, O,
// on the object, and of a pixel the share s shows what is behind. So the fraction
// (s B g_behind + (1 - s) O g_object) / (s B + (1 - s) O) of its light is gone, each g being the blurred mean on its side of
// the outline: what is dark counts little. B and O are those of the video a few pixels away, on the outline's normal; s is
// found from them and v, so that it is that of the outline in the video though the body's is a pixel beside it.

uniform sampler2D silhouette;  // as compositing/silhouette.frag draws it
// To be normalised, of means on either side, and of the composite's blur together with the outline's error.
uniform float outline_means[OUTLINE_REACH + 1];
uniform float outline_bounds[OUTLINE_REACH + 1];
uniform float outline_sigma_px;  // of outline_bounds
const int LOOKS = 8;
const int NEAR_LOOKS = 2;  // the first of them
// From the drawn outline to where the video is looked at on either side, across and along it. From there and without gaps,
// what is seen is the same across the outline and changes slowly along it. From each pixel, and with gaps, grain decided
// anew in each whether the sides are even, and left specks and teeth.
uniform vec2 looks_px[LOOKS];
const vec2 EVEN_SIDES = vec2(0.06, 0.18);  // deviation of what is seen there, of both sides' difference, up to which they are even, and from which on not
// Of that difference, change of a side with the distance from the outline, from which on, and up to which, it has a rim.
const vec2 RIM = vec2(0.3, 0.8);
uniform float border_step_px;  // of the video, in pixels of the viewport
// Of both sides' difference, by how much a pixel, or what is near the outline, may be brighter or darker than both sides,
// as a sharpened border is, and from how much on there is something else: a rim of the object, or what stands there.
const vec2 BEYOND_BOTH = vec2(0.2, 0.4);
const vec2 CONTRAST = vec2(0.2, 0.4);  // difference of B and O, of the brighter one, from which on it matters, and wholly

struct Sides {
    vec4 light_behind, light_object;
    vec3 gone_behind, gone_object;
    float pure_behind, pure_object;  // weights
    float bound_behind, bound_object;
    vec2 outwards;  // from the object
};

// What the layers become in a pixel with the outline within reach.
struct AcrossOutline {
    vec4 light;
    vec3 gone;
    float nearness;  // of the outline, from 0 to 1
};

float brightness_at(vec2 at) {
    return dot(linear_from_srgb(textureLod(video, at, 0.0).rgb), LUMINANCE);
}

// `seen` is the video in the pixel. What is gone of the ground is that of pixels beside the outline, without the factor of
// video_borders.glsl: how much light can be taken in this pixel is not known, as the object is a part of what it shows.
AcrossOutline across_outline(vec2 middle, vec2 at, vec3 seen) {
    Sides sides = Sides(vec4(0.0), vec4(0.0), vec3(0.0), vec3(0.0), 0.0, 0.0, 0.0, 0.0, vec2(0.0));
    for (int row = -OUTLINE_REACH; row <= OUTLINE_REACH; ++row) {
        int columns = OUTLINE_REACH - abs(row);
        for (int column = -columns; column <= columns; ++column) {
            vec2 of_object = read(silhouette, middle, column, row).rg;
            float object = of_object.r, behind = 1.0 - object;
            vec4 light = read(added_light, middle, column, row);
            vec3 gone = read(removed, middle, column, row).rgb;
            float bound = outline_bounds[abs(row)] * outline_bounds[abs(column)];
            // Outlines are smoothed: pixels beside them have something of both sides.
            vec2 pure = max(vec2(1.0 - 5.0 * of_object.g, 5.0 * of_object.g - 4.0), 1e-4);
            pure *= outline_means[abs(row)] * outline_means[abs(column)];
            sides.pure_behind += pure.x;
            sides.pure_object += pure.y;
            sides.light_behind += pure.x * light;
            sides.light_object += pure.y * light;
            sides.gone_behind += pure.x * gone;
            sides.gone_object += pure.y * gone;
            sides.bound_behind += bound * behind;
            sides.bound_object += bound * object;
            sides.outwards += bound * (behind - object) * vec2(column, row);
        }
    }
    bool is_at = min(sides.bound_behind, sides.bound_object) > 1e-5;
    vec2 outwards = sides.outwards / max(length(sides.outwards), 1e-6);
    float bound = sides.bound_behind / max(sides.bound_behind + sides.bound_object, 1e-9);
    // By how far the pixel is outside of the drawn outline. A logistic curve is all but the integral of a Gaussian.
    float outside_px = outline_sigma_px / 1.702 * log(max(bound, 1e-3) / max(1.0 - bound, 1e-3));
    vec2 outline = -clamp(outside_px, -float(OUTLINE_REACH), float(OUTLINE_REACH)) * outwards;
    vec2 sideways = vec2(-outwards.y, outwards.x);
    // Of the video, behind the object and on it: sums near the outline, and over what is farther from it.
    vec2 near = vec2(0.0), near_count = vec2(0.0), far = vec2(0.0), squares = vec2(0.0), count = vec2(0.0);
    for (int look = 0; look < 2 * LOOKS; ++look) {
        bool is_behind = look < LOOKS;
        vec2 place = looks_px[look % LOOKS];
        vec2 aside = outline + place.x * (is_behind ? outwards : -outwards) + place.y * sideways;
        float object = textureLod(silhouette, (middle + aside) / vec2(textureSize(silhouette, 0)), 0.0).r;
        float brightness = brightness_at(at + aside / viewport.zw);
        vec2 counted = is_behind ? vec2(object < 0.5, 0.0) : vec2(0.0, object > 0.5);
        if (look % LOOKS < NEAR_LOOKS) {
            near += brightness * counted;
            near_count += counted;
        } else {
            far += brightness * counted;
            squares += brightness * brightness * counted;
            count += counted;
        }
    }
    float share = 0.5, matters = 0.0;
    float level_behind = 1.0, level_object = 1.0;
    if (min(count.x, count.y) > 0.0) {
        far /= count;
        vec2 deviations = sqrt(max(squares / count - far * far, 0.0));
        float even = 1.0 - smoothstep(EVEN_SIDES.x, EVEN_SIDES.y, max(deviations.x, deviations.y) / max(abs(far.x - far.y), 1e-4));
        // What is less like the other side is farther from the border's blur.
        bool is_object_dark = far.x > far.y;
        near = mix(near / max(near_count, 1.0), far, equal(near_count, vec2(0.0)));
        vec2 changes = abs(near - far) / max(abs(far.x - far.y), 1e-4);
        even *= 1.0 - smoothstep(RIM.x, RIM.y, max(changes.x, changes.y));
        vec2 both = vec2(min(far.x, far.y), max(far.x, far.y));
        vec3 here = vec3(near, dot(seen, LUMINANCE));
        vec3 beyond = abs(here - clamp(here, both.x, both.y));
        float beyond_both = max(max(beyond.x, beyond.y), beyond.z) / max(both.y - both.x, 1e-4);
        level_behind = is_object_dark ? max(near.x, far.x) : min(near.x, far.x);
        level_object = is_object_dark ? min(near.y, far.y) : max(near.y, far.y);
        float difference = level_behind - level_object;
        float contrast = abs(difference) / max(max(level_behind, level_object), 1e-3);
        matters = even * smoothstep(CONTRAST.x, CONTRAST.y, contrast);
        matters *= 1.0 - smoothstep(BEYOND_BOTH.x, BEYOND_BOTH.y, beyond_both);
        difference = is_object_dark ? max(difference, 1e-4) : min(difference, -1e-4);
        // What rises or falls on one side only is a rim of the object or a pattern of the ground, and not the border.
        vec2 pixel = border_step_px * outwards / viewport.zw;
        vec3 shares = (vec3(brightness_at(at - pixel), dot(seen, LUMINANCE), brightness_at(at + pixel)) - level_object) / difference;
        float seen_share = max(min(shares.x, shares.z), min(max(shares.x, shares.z), shares.y));
        share = clamp(seen_share, smoothstep(0.8, 1.0, bound), smoothstep(0.0, 0.2, bound));
    }
    float from_behind = share * level_behind + 1e-4, from_object = (1.0 - share) * level_object + 1e-4;
    vec3 gone_behind = sides.gone_behind / max(sides.pure_behind, 1e-20);
    vec3 gone_object = sides.gone_object / max(sides.pure_object, 1e-20);
    vec4 light_behind = sides.light_behind / max(sides.pure_behind, 1e-20);
    vec4 light_object = sides.light_object / max(sides.pure_object, 1e-20);
    matters *= 1.0 - clamp(light_object.a, 0.0, 1.0);  // a model in front of the object hides its outline
    vec4 light = mix(light_object, light_behind, share);
    vec3 gone = (from_behind * gone_behind + from_object * gone_object) / (from_behind + from_object);
    return AcrossOutline(light, gone, is_at ? matters * smoothstep(0.0, 0.1, min(bound, 1.0 - bound)) : 0.0);
}
