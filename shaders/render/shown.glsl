// What masks and a field show of a point (RenderFrame::shown).
#ifndef PALPATE_RENDER_SHOWN_GLSL
#define PALPATE_RENDER_SHOWN_GLSL
#include "shaders/shared/brush.h"
#include "shaders/shared/ramp.h"
#include "shaders/shared/render.h"

// `word`: of a mask, with the point's bit.
bool isIn(uint word, uint point) { return (word >> point % 32 & 1) != 0; }

bool isHidden(RenderFrames frame, uint point) {
  return (frame.at[0].shown & kShownHidden) != 0 && isIn(frame.at[0].hidden.at[point / 32], point);
}

// Whether a point is drawn as a disc.
bool isDisc(RenderFrames frame, uint point) { return point >= frame.at[0].firstDisc && !isHidden(frame, point); }

// A colour of a point, as its lock and its selection tint it.
vec3 tinted(RenderFrames frame, uint point, vec3 color) {
  const uint shown = frame.at[0].shown;
  const bool isSelected = (shown & kShownSelected) != 0 && isIn(frame.at[0].selected.at[point / 32], point);
  if (isSelected) color = mix(color, kSelectedColor, kSelectedShare);
  if ((shown & kShownLock) == 0) return color;
  const uint weight = frame.at[0].lock.at[point / 4] >> 8 * (point % 4) & 255;
  return mix(color, isSelected ? kSelectedLockColor : kLockColor, kLockShare * float(weight) / 255.0);
}

// RGBA8: the base colour of the material for what is not painted.
uint paintOf(RenderFrames frame, uint color) { return color == kUnpainted ? frame.at[0].unpainted : color; }

// RGBA8. `colors`: the points' own, if they have any.
uint shownColor(RenderFrames frame, Uints colors, uint point) {
  const uint shown = frame.at[0].shown;
  const uint color = paintOf(frame, (shown & kShownColors) != 0 ? colors.at[point] : kUnpainted);
  if ((shown & (kShownField | kShownSelected | kShownLock)) == 0) return color;
  vec3 result = unpackUnorm4x8(color).rgb;
  if ((shown & kShownField) != 0) {
    const float value = uintBitsToFloat(frame.at[0].values.at[point]);
    result = isnan(value) ? kNoNumberColor
                          : numberColor(frame.at[0].colorMap, value, frame.at[0].lowValue, frame.at[0].highValue);
  }
  return packUnorm4x8(vec4(tinted(frame, point, result), 1));
}

#endif
