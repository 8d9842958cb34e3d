#version 460
#extension GL_GOOGLE_include_directive : require
#define PALPATE_WIDE_SUMS
// Pass 4 with atomics of 64 bits.
#include "shaders/render/splat_attributes.glsl"
