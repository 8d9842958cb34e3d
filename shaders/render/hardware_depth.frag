#version 460
#extension GL_GOOGLE_include_directive : require
// Discs by the graphics pipeline, pass 1: the depth test keeps the nearest depth of every sample.
#include "shaders/render/hardware_fragment.glsl"

void main() { fragmentHere(); }
