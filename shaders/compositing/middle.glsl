// Where the layers have what a pixel of the picture shows.

uniform vec4 viewport;  // left, bottom, width, height in pixels
#ifdef BENDS
uniform sampler2D straight_from_bent;  // a coarse grid: undistorted coordinates for those of the video
uniform vec4 region;  // of the pinhole picture, in which something was drawn
#endif

// The place in the layers, in pixels, of a place of the video, in shares of its width and height.
vec2 layers_at(vec2 at) {
#ifdef BENDS
    vec2 nodes = vec2(textureSize(straight_from_bent, 0));
    at = texture(straight_from_bent, (at * (nodes - 1.0) + 0.5) / nodes).xy;
#endif
    return viewport.xy + at * viewport.zw;
}

// The place in the layers, in pixels, about which the composite blurs them.
vec2 middle_of_blurs() {
#ifdef BENDS
    return layers_at((gl_FragCoord.xy - viewport.xy) / viewport.zw);
#else
    return gl_FragCoord.xy;
#endif
}

// The same place in the coordinates of a texture of half the resolution.
vec2 in_coarse(vec2 middle, sampler2D coarse) {
    return middle / (2.0 * vec2(textureSize(coarse, 0)));
}
