// Outputs of the vertex shader for the fragment shaders about a disc. HARDWARE_DISC is `out` in the former and `in` in
// the latter.
#ifndef PALPATE_RENDER_HARDWARE_DISC_GLSL
#define PALPATE_RENDER_HARDWARE_DISC_GLSL
#include "shaders/render/disc.glsl"
#include "shaders/shared/hardware_raster.h"

layout(push_constant, scalar) uniform Push { HardwareDiscArgs args; };

layout(location = 0) HARDWARE_DISC Drawn {
  flat vec4 center;   // w: 1 / radius squared
  flat vec4 normal;   // w: how much nearer its fragments are tested, model units
  flat vec4 clip;     // w: trust
  flat vec3 shading;
  flat ivec2 centerPixel;
  flat ivec4 box;     // first and last pixel: of several sprites, which are square, none may reach into the next one
  flat uint color;    // RGBA8
} drawn;

#endif
