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
    float weight;
};

OfGround adding(OfGround sums, float weight, vec3 gone, float removable) {
    float counted = removable < 0.0 ? 0.0 : weight;
    return OfGround(sums.gone + counted * vec4(gone, removable + FAINT), sums.weight + counted);
}

// By what the ground's part is multiplied in a pixel of the ground; 1 where there is no such border.
float factor_at(float removable, OfGround sums) {
    return removable < 0.0 || sums.weight == 0.0 ? 1.0 : min((removable + FAINT) * sums.weight / max(sums.gone.a, 1e-6), MOST);
}
