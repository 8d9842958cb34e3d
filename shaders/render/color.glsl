// Colours: between the encoding of files and screens (sRGB) and linear light, and a ramp for numbers.
#ifndef PALPATE_RENDER_COLOR_GLSL
#define PALPATE_RENDER_COLOR_GLSL

vec3 toLinear(vec3 encoded) {
  return mix(encoded / 12.92, pow((encoded + 0.055) / 1.055, vec3(2.4)), greaterThan(encoded, vec3(0.04045)));
}
vec3 toEncoded(vec3 light) {
  light = clamp(light, 0, 1);
  return mix(light * 12.92, 1.055 * pow(light, vec3(1 / 2.4)) - 0.055, greaterThan(light, vec3(0.0031308)));
}

// From deep blue over green to warm yellow for x from 0 to 1, ever brighter, linear light.
vec3 ramp(float x) {
  const vec3 anchors[5] = vec3[5](vec3(0.10, 0.13, 0.38), vec3(0.11, 0.37, 0.58), vec3(0.16, 0.60, 0.55),
                                  vec3(0.58, 0.78, 0.40), vec3(0.98, 0.87, 0.45));
  const float place = clamp(x, 0, 1) * 4;
  const uint below = min(uint(place), 3);
  return toLinear(mix(anchors[below], anchors[below + 1], place - float(below)));
}

#endif
