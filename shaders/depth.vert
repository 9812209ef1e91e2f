// The model as the light sees it.
#version 330 core

uniform mat4 clip_from_marker;

in vec3 in_position;
#ifdef BASE_MAP
in vec2 in_uv;
#ifdef LAID_OUT
#ifdef MORE_UVS
in vec2 in_more_uv;
#endif
out vec4 uvs;
#else
out vec2 uv;
#endif
#endif

void main() {
#ifdef BASE_MAP
#ifndef LAID_OUT
    uv = in_uv;
#elif defined(MORE_UVS)
    uvs = vec4(in_uv, in_more_uv);
#else
    uvs = vec4(in_uv, 0.0, 0.0);
#endif
#endif
    gl_Position = clip_from_marker * vec4(in_position, 1.0);
}
