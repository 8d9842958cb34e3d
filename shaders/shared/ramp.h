// Colours for numbers, in pictures and in the legends beside them.
#ifndef PALPATE_SHARED_RAMP_H
#define PALPATE_SHARED_RAMP_H
#include "shaders/shared/types.h"

PALPATE_SHARED_BEGIN

// Colour maps. All but that of classes are ramps over a range.
const uint kMapViridis = 0;  // after van der Walt and Smith 2015
const uint kMapTurbo = 1;    // after Mikhailov 2019
const uint kMapGrey = 2;
const uint kMapRedBlue = 3;  // white in the middle
const uint kMapClasses = 4;  // a colour for each whole number: classes of LAS
const uint kMapTerrain = 5;  // from deep blue over green to warm yellow, with increasing brightness
// Colour of points without a number, sRGB.
const vec3 kNoNumberColor = vec3(0.5f, 0.5f, 0.5f);

// 0xRRGGBB, sRGB.
PALPATE_FUNCTION vec3 colorOf(uint rgb) {
  return vec3(float(rgb >> 16u & 255u), float(rgb >> 8u & 255u), float(rgb & 255u)) / 255.0f;
}

// The ends of the pieces of a ramp, between which colours are interpolated.
PALPATE_FUNCTION uint rampPieces(uint map) {
  if (map == kMapGrey) return 1u;
  if (map == kMapRedBlue) return 4u;
  return map == kMapTurbo ? 12u : 8u;
}
PALPATE_FUNCTION uint rampEnd(uint map, uint k) {
  switch (16u * map + k) {
    case 0u:
      return 0x440154u;
    case 1u:
      return 0x472d7bu;
    case 2u:
      return 0x3b528bu;
    case 3u:
      return 0x2c728eu;
    case 4u:
      return 0x21918cu;
    case 5u:
      return 0x28ae80u;
    case 6u:
      return 0x5ec962u;
    case 7u:
      return 0xaddc30u;
    case 8u:
      return 0xfde725u;
    case 16u:
      return 0x23171bu;
    case 17u:
      return 0x4b4cccu;
    case 18u:
      return 0x3887f9u;
    case 19u:
      return 0x26bde1u;
    case 20u:
      return 0x2fe5adu;
    case 21u:
      return 0x58fb79u;
    case 22u:
      return 0x96fa50u;
    case 23u:
      return 0xd5e336u;
    case 24u:
      return 0xffb827u;
    case 25u:
      return 0xff801du;
    case 26u:
      return 0xe34613u;
    case 27u:
      return 0xad1905u;
    case 28u:
      return 0x900d00u;
    case 32u:
      return 0x1a1a1au;
    case 33u:
      return 0xf2f2f2u;
    case 48u:
      return 0xb2182bu;
    case 49u:
      return 0xf4a582u;
    case 50u:
      return 0xf7f7f7u;
    case 51u:
      return 0x92c5deu;
    case 52u:
      return 0x2166acu;
  }
  return 0u;
}
// For x from 0 to 1, sRGB.
PALPATE_FUNCTION vec3 terrainColor(float x) {
  const vec3 a = vec3(0.10f, 0.13f, 0.38f), b = vec3(0.11f, 0.37f, 0.58f), c = vec3(0.16f, 0.60f, 0.55f);
  const vec3 d = vec3(0.58f, 0.78f, 0.40f), e = vec3(0.98f, 0.87f, 0.45f);
  const float place = 4.0f * clamp(x, 0.0f, 1.0f);
  if (place < 1.0f) return a + place * (b - a);
  if (place < 2.0f) return b + (place - 1.0f) * (c - b);
  if (place < 3.0f) return c + (place - 2.0f) * (d - c);
  return d + (place - 3.0f) * (e - d);
}
PALPATE_FUNCTION vec3 rampColor(uint map, float x) {
  if (map == kMapTerrain) return terrainColor(x);
  const uint pieces = rampPieces(map);
  const float place = float(pieces) * clamp(x, 0.0f, 1.0f);
  const uint k = place < float(pieces) ? uint(place) : pieces - 1u;
  const vec3 a = colorOf(rampEnd(map, k)), b = colorOf(rampEnd(map, k + 1u));
  return a + (place - float(k)) * (b - a);
}

// The standard classes of LAS 1.4, as usual; others are told apart.
PALPATE_FUNCTION vec3 classColor(float number) {
  const uint of = uint(int(clamp(floor(number + 0.5f), -1e9f, 1e9f)));
  switch (of) {
    case 0u:
      return colorOf(0xb0b0b0u);
    case 1u:
      return colorOf(0xd9d9d9u);
    case 2u:
      return colorOf(0xa0703cu);  // ground
    case 3u:
      return colorOf(0xb8e186u);  // vegetation: low, medium, high
    case 4u:
      return colorOf(0x5fbf4au);
    case 5u:
      return colorOf(0x1b7a32u);
    case 6u:
      return colorOf(0xe8602cu);  // building
    case 7u:
      return colorOf(0xff00ffu);  // noise
    case 8u:
      return colorOf(0x8c564bu);  // model key point
    case 9u:
      return colorOf(0x2b7bdbu);  // water
    case 10u:
      return colorOf(0x6a3d9au);  // rail
    case 11u:
      return colorOf(0x5a6470u);  // road
    case 12u:
      return colorOf(0xf0e442u);  // overlap
    case 13u:
      return colorOf(0x00c8c8u);  // wires, tower, connector
    case 14u:
      return colorOf(0x00a0ffu);
    case 15u:
      return colorOf(0xffb000u);
    case 16u:
      return colorOf(0x9d7bffu);
    case 17u:
      return colorOf(0xc49a6cu);  // bridge
    case 18u:
      return colorOf(0xc2006bu);  // high noise
  }
  return rampColor(kMapTurbo, float(of * 7u % 19u) / 18.0f);
}

// What a number looks like if `low` and `high` are the ends of the ramp.
PALPATE_FUNCTION vec3 numberColor(uint map, float number, float low, float high) {
  if (map == kMapClasses) return classColor(number);
  return rampColor(map, (number - low) / (high - low > 1e-30f ? high - low : 1e-30f));
}

PALPATE_SHARED_END
#endif
