// What masks and a field show of a point (RenderFrame::shown).
#ifndef PALPATE_RENDER_SHOWN_GLSL
#define PALPATE_RENDER_SHOWN_GLSL
#include "shaders/shared/brush.h"
#include "shaders/shared/ramp.h"
#include "shaders/render/frame_block.glsl"

// `word`: of a mask, with the point's bit.
bool isIn(uint word, uint point) { return (word >> point % 32 & 1) != 0; }

bool isHidden(uint point) {
  return (frame.shown & kShownHidden) != 0 && isIn(frame.hidden.at[point / 32], point);
}

// Whether a point is drawn as a disc.
bool isDisc(uint point) { return point >= frame.firstDisc && !isHidden(point); }

// A colour of a point, as its lock and its selection tint it.
vec3 tinted(uint point, vec3 color) {
  const uint shown = frame.shown;
  const bool isSelected = (shown & kShownSelected) != 0 && isIn(frame.selected.at[point / 32], point);
  if (isSelected) color = mix(color, kSelectedColor, kSelectedShare);
  if ((shown & kShownLock) == 0) return color;
  const uint weight = frame.lock.at[point / 4] >> 8 * (point % 4) & 255;
  return mix(color, isSelected ? kSelectedLockColor : kLockColor, kLockShare * float(weight) / 255.0);
}

// RGBA8: the base colour of the material for what is not painted.
uint paintOf(uint color) { return color == kUnpainted ? frame.unpainted : color; }

// RGBA8. `colors`: the points' own, if they have any.
uint shownColor(Uints colors, uint point) {
  const uint shown = frame.shown;
  const uint color = paintOf((shown & kShownColors) != 0 ? colors.at[point] : kUnpainted);
  if ((shown & (kShownField | kShownSelected | kShownLock)) == 0) return color;
  vec3 result = unpackUnorm4x8(color).rgb;
  if ((shown & kShownField) != 0) {
    const float value = uintBitsToFloat(frame.values.at[point]);
    result = isnan(value) ? kNoNumberColor
                          : numberColor(frame.colorMap, value, frame.lowValue, frame.highValue);
  }
  return packUnorm4x8(vec4(tinted(point, result), 1));
}

#endif
