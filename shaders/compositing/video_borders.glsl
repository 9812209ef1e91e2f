// How the fraction that is gone of the ground's light is blurred where the video has a border that is blurred already: that
// of the real object's shadow.
//
// The lights send S R to a place, where the real object lets R through and the sky adds A. A model that lets V through takes
// S R (1 - V) / (A + S R) = t h of it, where t is known for each pixel of the video, and h has the borders of the model's
// shadow.
// The camera blurs V, but not t a second time: a line of light would be left, as more is taken from a dark pixel, and less
// from a bright one, than they have. So the ground's part of the blur becomes t G(t h) / G(t).

const float FAINT = 0.03;  // of t, below which nothing can be told about h
const float MOST = 1.5;  // by which the blurred fraction is raised at most: more than any border of a shadow asks for
#ifdef COVERS
const float BARE_ALPHA = COVER_ALPHA;  // of the added light, where the ground is covered
#else
const float BARE_ALPHA = 0.0;
#endif

// t of what a pixel of the layers shows; -1 where that is not the ground alone.
float removable_in(vec4 light, vec4 gone) {
    bool is_bare = min(light.a, abs(light.a - BARE_ALPHA)) < 0.002;
    float removable = (gone.a - NONE_REMOVABLE) / (ALL_REMOVABLE - NONE_REMOVABLE);
    return is_ground(gone.a) && is_bare ? max(removable, 0.0) : -1.0;
}

// Weighted sums over the ground within a blur's reach.
struct OfGround {
    vec4 gone;  // the fraction that is gone, and t + FAINT
    float brightness;  // of what is gone, where it is not negative: t h
    float weight;
};

OfGround adding(OfGround sums, float weight, vec3 gone, float removable) {
    float counted = removable < 0.0 ? 0.0 : weight;
    float brightness = sums.brightness + counted * max(dot(gone, LUMINANCE), 0.0);
    return OfGround(sums.gone + counted * vec4(gone, removable + FAINT), brightness, sums.weight + counted);
}

// By what the ground's part is multiplied in a pixel of the ground; 1 where there is no such border.
float factor_at(float removable, OfGround sums) {
    return removable < 0.0 || sums.weight == 0.0 ? 1.0 : min((removable + FAINT) * sums.weight / max(sums.gone.a, 1e-6), MOST);
}

const vec2 CLEAR = vec2(0.05, 0.15);  // of h in a pixel, from which on its colour can be told, and is

// What is gone of the ground's light in such a pixel, times the ground's weight: t G(t h) / G(t) in the colours of the pixel
// itself, which are those of the border in the video. Where a camera has sharpened the border, its dark side is darker than
// the shadow, and what is gone is negative while t is 0.
vec3 gone_at_border(vec3 own, float removable, float factor, OfGround sums) {
    vec3 blurred = factor * sums.gone.rgb;
    if (removable < 0.0 || sums.weight == 0.0) return blurred;
    float h = sums.brightness / max(sums.gone.a - FAINT * sums.weight, 0.1 * FAINT);
    float own_h = removable < FAINT ? h : dot(own, LUMINANCE) / removable;
    vec3 coloured = sums.weight * own * clamp(h / max(own_h, 1e-3), 0.0, MOST);
    return mix(blurred, coloured, smoothstep(CLEAR.x, CLEAR.y, own_h));
}
