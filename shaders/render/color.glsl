// Colours: between the encoding of files and screens (sRGB) and linear light.
#ifndef PALPATE_RENDER_COLOR_GLSL
#define PALPATE_RENDER_COLOR_GLSL

vec3 toLinear(vec3 encoded) {
  return mix(encoded / 12.92, pow((encoded + 0.055) / 1.055, vec3(2.4)), greaterThan(encoded, vec3(0.04045)));
}
vec3 toEncoded(vec3 light) {
  light = clamp(light, 0, 1);
  return mix(light * 12.92, 1.055 * pow(light, vec3(1 / 2.4)) - 0.055, greaterThan(light, vec3(0.0031308)));
}

#endif
