#include "apps/cli/legend.hpp"

#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "apps/cli/font.hpp"
#include "shaders/shared/ramp.h"

namespace palpate {

namespace {

constexpr double kLetter = 0.024;  // height of letters, as a share of the picture's
constexpr double kSmallest_px = 9;
constexpr double kLine = 1.35;  // from one entry of a legend to the next, letters

double letterHeight_px(const Image& image) {
  return std::round(std::max(kSmallest_px, kLetter * static_cast<double>(image.height)));
}

/// Blends a colour over a pixel; no effect outside the picture.
void blend(Image& image, int x, int y, const DVec3& color, double alpha) {
  if (x < 0 || y < 0 || x >= static_cast<int>(image.width) || y >= static_cast<int>(image.height)) return;
  auto& pixel = image.rgba[static_cast<std::size_t>(y) * image.width + static_cast<std::size_t>(x)];
  const double covered = 1 - (1 - pixel[3] / 255.0) * (1 - alpha);
  if (covered <= 0) return;
  for (int k = 0; k < 3; ++k) {
    auto& channel = pixel[static_cast<std::size_t>(k)];
    channel = static_cast<std::uint8_t>(std::lround(glm::mix(static_cast<double>(channel), color[k], alpha / covered)));
  }
  pixel[3] = static_cast<std::uint8_t>(std::lround(255 * covered));
}

/// White on a dark background, black on a light or a transparent one, as most pages are white.
DVec3 inkOn(const Image& image, int x, int y, int width, int height) {
  double sum = 0, count = 0;
  for (int v = std::max(0, y); v < std::min(y + height, static_cast<int>(image.height)); ++v)
    for (int u = std::max(0, x); u < std::min(x + width, static_cast<int>(image.width)); ++u) {
      const auto& p = image.at(static_cast<std::uint32_t>(u), static_cast<std::uint32_t>(v));
      sum += p[3] / 255.0 * (0.3 * p[0] + 0.59 * p[1] + 0.11 * p[2]) + (255 - p[3]);
      ++count;
    }
  constexpr double kLight = 130;
  return DVec3(count > 0 && sum / count > kLight ? 20 : 240);
}

/// Unlike the letters on it.
void drawPlate(Image& image, int x, int y, int width, int height) {
  constexpr double kPlate = 0.6;
  const DVec3 plate = DVec3(255) - inkOn(image, x, y, width, height);
  for (int v = y; v < y + height; ++v)
    for (int u = x; u < x + width; ++u) blend(image, u, v, plate, kPlate);
}

/// Letters of one height.
class Letters {
 public:
  explicit Letters(double height_px) {
    addFont(atlas_, static_cast<float>(height_px), Texels::pixels);
    atlas_.GetTexDataAsAlpha8(&texels_, &width_, &height_);
    font_ = atlas_.Fonts[0];
  }

  double widthOf(const std::string& text) const {
    double width = 0;
    for (const char c : text) width += double{glyph(c).AdvanceX};
    return width;
  }

  /// `x`, `y`: the upper left corner of the line, pixels.
  void draw(Image& image, int x, int y, const std::string& text) const {
    const DVec3 ink = inkOn(image, x, y, static_cast<int>(widthOf(text)), static_cast<int>(font_->FontSize));
    double at = x;
    for (const char c : text) {
      const ImFontGlyph& g = glyph(c);
      const int left = static_cast<int>(std::lround(at + double{g.X0})), top = y + static_cast<int>(g.Y0);
      const int u0 = texel(g.U0, width_), u1 = texel(g.U1, width_), v0 = texel(g.V0, height_),
                v1 = texel(g.V1, height_);
      for (int v = v0; v < v1; ++v)
        for (int u = u0; u < u1; ++u) blend(image, left + u - u0, top + v - v0, ink, texels_[v * width_ + u] / 255.0);
      at += double{g.AdvanceX};
    }
  }

 private:
  const ImFontGlyph& glyph(char c) const { return *font_->FindGlyph(static_cast<ImWchar>(c)); }
  static int texel(float along, int size) { return static_cast<int>(std::lround(along * static_cast<float>(size))); }

  ImFontAtlas atlas_;
  ImFont* font_ = nullptr;
  unsigned char* texels_ = nullptr;
  int width_ = 0, height_ = 0;
};

}  // namespace

void drawLegend(Image& image, const Legend& legend, LabelRoom& room) {
  const Letters letters(letterHeight_px(image));
  const double letter = letterHeight_px(image), height = static_cast<double>(image.height);
  const double line = kLine * letter;
  const int right = static_cast<int>(image.width - letter), left = right - static_cast<int>(letter);
  const double entries = line * static_cast<double>(legend.entries.size());
  const auto fill = [&](int top, int bottom, auto&& colorAt) {
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x) blend(image, x, y, 255.0 * DVec3(colorAt(y)), 1);
  };
  const auto write = [&](const std::string& text, double y) {
    letters.draw(image, static_cast<int>(left - 0.5 * letter - letters.widthOf(text)),
                 static_cast<int>(std::lround(y - 0.5 * letter)), text);
  };
  const bool isRamp = !legend.marks.empty();
  const int top = static_cast<int>(isRamp ? 0.28 * height : std::max(3 * letter, 0.5 * (height - entries)));
  const int bottom = static_cast<int>(isRamp ? 0.72 * height : top);
  // A plate under it all, so that it is read over any model.
  double widest = letters.widthOf(legend.heading) - 1.5 * letter;
  for (const Legend::Mark& mark : legend.marks) widest = std::max(widest, letters.widthOf(mark.text));
  for (const Legend::Entry& entry : legend.entries) widest = std::max(widest, letters.widthOf(entry.text));
  const int plateLeft = static_cast<int>(left - widest - letter), plateTop = static_cast<int>(top - 2.2 * letter);
  const int plateBottom = static_cast<int>(bottom + entries + (isRamp && entries > 0 ? 1.5 : 0.7) * letter);
  drawPlate(image, plateLeft, plateTop, static_cast<int>(right + 0.5 * letter) - plateLeft, plateBottom - plateTop);
  room.reserve({plateLeft, plateTop}, {right + 0.5 * letter, plateBottom});
  fill(top, bottom, [&](int y) {
    const float share = (static_cast<float>(bottom - y) - 0.5f) / static_cast<float>(bottom - top);
    return shared::rampColor(static_cast<std::uint32_t>(legend.map), share);
  });
  for (const Legend::Mark& mark : legend.marks) {
    const double y = bottom - mark.share * (bottom - top);
    const int row = std::clamp(static_cast<int>(std::lround(y)), top, bottom - 1);
    const DVec3 ink = inkOn(image, left, row, right - left, 1);
    for (int x = left; x < left + static_cast<int>(0.4 * letter); ++x) blend(image, x, row, ink, 0.9);
    write(mark.text, y);
  }
  double at = bottom + (isRamp ? letter : 0);
  for (const Legend::Entry& entry : legend.entries) {
    fill(static_cast<int>(at + 0.15 * line), static_cast<int>(at + 0.85 * line), [&](int) { return entry.color; });
    write(entry.text, at + 0.5 * line);
    at += line;
  }
  letters.draw(image, static_cast<int>(right - letters.widthOf(legend.heading)), static_cast<int>(top - 1.8 * letter),
               legend.heading);
}

void drawText(Image& image, const DVec2& at_px, const std::string& text, LabelRoom& room) {
  const double letter = letterHeight_px(image);
  const Letters letters(letter);
  letters.draw(image, static_cast<int>(at_px.x), static_cast<int>(at_px.y - letter), text);
  room.reserve(at_px - DVec2(0, letter), at_px + DVec2(letters.widthOf(text), 0));
}

void drawLabel(Image& image, const PictureLabel& label, LabelRoom& room) {
  const double letter = letterHeight_px(image), padding = std::round(0.3 * letter);
  const Letters letters(letter);
  const DVec2 plate_px(std::ceil(letters.widthOf(label.text)) + 2 * padding, letter + 2 * padding);
  const DVec2 room_px = glm::max(DVec2(0), DVec2(image.width, image.height) - plate_px);
  const DVec2 corner_px = glm::clamp(glm::round(label.at_px - 0.5 * plate_px), DVec2(0), room_px);
  if (!room.admits(label, corner_px, corner_px + plate_px)) return;
  const int x = static_cast<int>(corner_px.x), y = static_cast<int>(corner_px.y);
  drawPlate(image, x, y, static_cast<int>(plate_px.x), static_cast<int>(plate_px.y));
  letters.draw(image, x + static_cast<int>(padding), y + static_cast<int>(padding), label.text);
}

}  // namespace palpate
