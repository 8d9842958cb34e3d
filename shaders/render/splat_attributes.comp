#version 460
#extension GL_GOOGLE_include_directive : require
// Pass 4 with atomics of 32 bits.
#include "shaders/render/splat_attributes.glsl"
