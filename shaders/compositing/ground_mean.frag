// The local mean brightness of the ground as it is shown, the cover in place of the marker's sheet: a texel stands for
// many pixels of the picture.
#version 330 core
#include "screen/srgb.glsl"
#include "compositing/middle.glsl"
#include "compositing/relief.glsl"
#ifdef COVERS
#include "catchers/cover.glsl"
#endif

uniform sampler2D video;
uniform vec2 means;  // how many texels are across and up the viewport

out float mean;

const int LOOKS = 8;  // along either side of a texel

void main() {
    float sum = 0.0;
    for (int look = 0; look < LOOKS * LOOKS; ++look) {
        vec2 within = (vec2(look % LOOKS, look / LOOKS) + 0.5) / float(LOOKS) - 0.5;
        vec2 at = (gl_FragCoord.xy + within) / means;
        vec3 seen = linear_from_srgb(textureLod(video, at, 0.0).rgb);
#ifdef COVERS
        vec4 covering = cover_in(layers_at(at));
        seen = mix(seen, covering.rgb, covering.a);
#endif
        sum += log_brightness(seen);
    }
    mean = sum / float(LOOKS * LOOKS);
}
