// Passes the vertices' texture coordinates on to layout.glsl in the fragment shader. Uses the including file's macros.

#ifdef HAS_MAPS
in vec2 in_uv;
#ifdef LAID_OUT
#ifdef MORE_UVS
in vec2 in_more_uv;
#endif
out vec4 uvs;  // two sets of texture coordinates
#else
out vec2 uv;
#endif
#endif

void pass_uvs() {
#ifdef HAS_MAPS
#ifndef LAID_OUT
    uv = in_uv;
#elif defined(MORE_UVS)
    uvs = vec4(in_uv, in_more_uv);
#else
    uvs = vec4(in_uv, 0.0, 0.0);
#endif
#endif
}
