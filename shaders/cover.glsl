// The ground that is shown in place of the marker's sheet. It is made from the video and so already as sharp as the video:
// the composite puts it behind the layers, without blurring it, where they say that it is visible.

uniform sampler2D cover;  // sRGB, straight alpha
uniform float cover_half_m;
uniform vec3 cover_gain;  // exposure of this frame over that of the frame that the cover was made from

// The alpha of covered pixels in the layer of added light. It differs from the model's 1, so that the model's outline is
// found in front of the cover as it is in front of bare video. It also scales the added noise: the cover keeps some noise of
// the frame that it was made from.
const float COVER_ALPHA = 0.45;

// Linear RGB, straight alpha.
vec4 cover_at(vec2 ground) {
    vec4 covering = texture(cover, 0.5 + 0.5 * ground / cover_half_m);
    return vec4(linear_from_srgb(covering.rgb) * cover_gain, covering.a);
}
