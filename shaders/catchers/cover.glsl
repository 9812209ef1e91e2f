// The ground that is shown in place of the marker's sheet. It is made from the video and so already as sharp as the video:
// the composite puts it behind the layers, without blurring it, where they say that it is visible.

uniform sampler2D cover;  // sRGB, straight alpha
uniform float cover_half_m;
uniform mat3 ground_from_pixel;  // of the pinhole camera's picture, to the marker's plane; homogeneous
// Exposure of this frame over that of the frame that the cover was made from, at the marker's centre; and how the log of
// brightness changes over the plane beside, per metre, as sheen moves with the camera.
uniform vec3 cover_gain;
uniform vec2 cover_slope;
// What has come over the sheet since: red, how much of it a thing hides; green, the log of the light on it over that before.
uniform sampler2D over_sheet;
uniform vec4 sheet_bounds;  // lower x, y and upper x, y of `over_sheet`; metres
uniform vec3 sheet_shadow;  // by how much a shadow darkens each channel where it darkens brightness by 1

// The alpha of covered pixels in the layer of added light. It differs from the model's 1, so that the model's outline is
// found in front of the cover as it is in front of bare video.
const float COVER_ALPHA = 0.45;

vec2 over_sheet_at(vec2 ground) {
    return texture(over_sheet, (ground - sheet_bounds.xy) / (sheet_bounds.zw - sheet_bounds.xy)).rg;
}

// Linear RGB, straight alpha.
vec4 cover_at(vec2 ground) {
    vec4 covering = texture(cover, 0.5 + 0.5 * ground / cover_half_m);
    vec2 over = over_sheet_at(ground);
    vec3 lit = linear_from_srgb(covering.rgb) * cover_gain * exp(dot(cover_slope, ground) + over.g * sheet_shadow);
    return vec4(lit, covering.a * (1.0 - over.r));
}

// The same in a pixel of the pinhole camera's picture: empty above the horizon.
vec4 cover_in(vec2 pixel) {
    vec3 ground = ground_from_pixel * vec3(pixel, 1.0);
    return ground.z > 0.0 ? cover_at(ground.xy / ground.z) : vec4(0.0);
}
