#include "engine/cloud/length_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace palpate {

std::string lengthText(double length, int digits) {
  constexpr double kDoubles = 1e15;  // doubles hold no more whole digits
  const double size = std::abs(length);
  return size >= std::pow(10.0, digits) && size < kDoubles ? fmt::format("{:.0f}", length)
                                                           : fmt::format("{:.{}g}", length, digits);
}

std::string lengthText(double length, LengthUnit unit, int digits) {
  return lengthText(length, digits) + ' ' + std::string(nameOf(unit));
}

std::string touchScaleText(const ModelScale& scale, double longestSide, LengthUnit unit) {
  const double side = longestSide > 0 ? longestSide : 1;
  return fmt::format("{:.4g} mm in the hand for {}", scale.toMm(side), lengthText(side, unit));
}

double resolutionOf(const Bounds& box) {
  constexpr double kFloat = 1.0 / (1 << 24);
  double farthest = 0;
  for (int axis = 0; axis < 3; ++axis)
    farthest = std::max({farthest, std::abs(box.min[axis]), std::abs(box.max[axis])});
  return farthest * kFloat;
}

std::string coordinateText(double coordinate, double resolution) {
  constexpr int kMaxDecimals = 15;
  constexpr double kDoubles = 1e15;
  if (!(resolution > 0) || !(std::abs(coordinate) < kDoubles)) return fmt::format("{:.15g}", coordinate);
  const int decimals = std::clamp(static_cast<int>(std::floor(-std::log10(resolution))), 0, kMaxDecimals);
  std::string text = fmt::format("{:.{}f}", coordinate, decimals);
  if (decimals > 0) text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string coordinateText(const DVec3& place, double resolution, const std::string& between) {
  return coordinateText(place.x, resolution) + between + coordinateText(place.y, resolution) + between +
         coordinateText(place.z, resolution);
}

}  // namespace palpate
