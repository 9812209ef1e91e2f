// A frame of three bytes a pixel, blue first and the top row first, as RGBA from the bottom row on.
#version 330 core

uniform sampler2D picture;  // one byte a texel, three beside each other for a pixel

out vec4 rgba;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    ivec2 blue = ivec2(3 * at.x, textureSize(picture, 0).y - 1 - at.y);
    rgba = vec4(
        texelFetch(picture, blue + ivec2(2, 0), 0).r,
        texelFetch(picture, blue + ivec2(1, 0), 0).r,
        texelFetch(picture, blue, 0).r,
        1.0
    );
}
