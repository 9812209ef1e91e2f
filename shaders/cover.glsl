// The ground in the place of the marker's sheet. As it is made of the video, it is as sharp as that already: the composite puts
// it behind the layers, unblurred, where these say that it is seen.

uniform sampler2D cover;  // sRGB, straight alpha
uniform float cover_half_m;
uniform vec3 cover_gain;  // exposure of this frame over that of the cover's

// In the layer of added light, of what is covered: told from the model by it, so that an outline before it is found as
// before bare video. It has as much of the noise that is given to the model, for it has some of the frame that it was made of.
const float COVER_ALPHA = 0.45;

// Linear RGB, straight alpha.
vec4 cover_at(vec2 ground) {
    vec4 covering = texture(cover, 0.5 + 0.5 * ground / cover_half_m);
    return vec4(linear_from_srgb(covering.rgb) * cover_gain, covering.a);
}
