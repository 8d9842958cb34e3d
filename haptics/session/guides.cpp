#include "haptics/session/guides.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "engine/cloud/length_text.hpp"
#include "engine/cloud/up.hpp"
#include "engine/core/error.hpp"

namespace palpate {

namespace {

using Color = std::array<std::uint8_t, 3>;
constexpr std::array<Color, 3> kAxisColors{{{230, 80, 75}, {105, 190, 80}, {80, 140, 240}}};
constexpr Color kBoxColor{150, 160, 175};
constexpr double kTick = 0.015;    // of the longest side
constexpr double kTextOff = 0.05;  // distance of a number from its axis, of the longest side
constexpr double kDigit = 0.1;     // of a step between coordinates: their last digit
constexpr double kPieces = 5;      // of the longest axis, about
constexpr double kSquares = 10;    // of the grid along the longest side, about
constexpr double kMargin = 0.1;    // of the grid beside the model, of the longest side
constexpr double kGridOpacity = 0.45;

/// The multiples of `step` from `low` to `high`, both included.
std::vector<double> multiples(double low, double high, double step) {
  std::vector<double> all;
  constexpr double kEdge = 1e-9;  // of a step
  const double first = std::ceil(low / step - kEdge), last = std::floor(high / step + kEdge);
  for (double k = first; k <= last; ++k) all.push_back(k * step);
  return all;
}

/// The corner of a box that is at its top along each axis whose bit is set.
DVec3 cornerOf(const Bounds& box, unsigned bits) {
  return {bits & 1 ? box.max.x : box.min.x, bits & 2 ? box.max.y : box.min.y, bits & 4 ? box.max.z : box.min.z};
}

void addBox(Guides& guides, const Bounds& box, LengthUnit unit) {
  for (unsigned from = 0; from < 8; ++from)
    for (const unsigned axis : {1u, 2u, 4u})
      if ((from & axis) == 0)
        guides.lines.push_back({.from = cornerOf(box, from), .to = cornerOf(box, from | axis), .color = kBoxColor});
  const DVec3 side = box.max - box.min;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(side[axis] > 0)) continue;
    DVec3 middle = box.max;
    middle[axis] = box.center()[axis];
    guides.labels.push_back({middle, lengthText(side[axis], unit, kFewLengthDigits)});
  }
}

void addAxes(Guides& guides, const Bounds& box, const DVec3& origin) {
  const DVec3 side = box.max - box.min;
  const double longest = box.longestSide(), step = roundLength(longest / kPieces);
  for (int axis = 0; axis < 3; ++axis) {
    if (!(side[axis] > 0)) continue;
    const Color color = kAxisColors[static_cast<std::size_t>(axis)];
    DVec3 end = box.min, away(0);
    end[axis] = box.max[axis];
    for (int other = 0; other < 3; ++other)
      if (other != axis) away[other] = -1;
    away = glm::normalize(away);
    guides.lines.push_back({.from = box.min, .to = end, .color = color, .width_px = 2});
    for (const double value : multiples(origin[axis] + box.min[axis], origin[axis] + box.max[axis], step)) {
      DVec3 at = box.min;
      at[axis] = value - origin[axis];
      guides.lines.push_back({.from = at, .to = at + kTick * longest * away, .color = color});
      guides.labels.push_back({at + kTextOff * longest * away, coordinateText(value, kDigit * step)});
    }
  }
}

void addGrid(Guides& guides, const Bounds& box, UpAxis up, LengthUnit unit, const DVec3& origin) {
  const double longest = box.longestSide(), step = roundLength(longest / kSquares);
  const DVec3 upward = directionOf(up);
  int height = 0;
  for (int axis = 0; axis < 3; ++axis)
    if (upward[axis] != 0) height = axis;
  const int u = (height + 1) % 3, v = (height + 2) % 3;
  const auto ends = [&](int axis) {
    const double low = origin[axis] + box.min[axis] - kMargin * longest,
                 high = origin[axis] + box.max[axis] + kMargin * longest;
    return DVec2(std::floor(low / step) * step, std::ceil(high / step) * step) - origin[axis];
  };
  const DVec2 along = ends(u), across = ends(v);
  const double ground = upward[height] > 0 ? box.min[height] : box.max[height];
  const auto at = [&](double a, double b) {
    DVec3 place(0);
    place[height] = ground, place[u] = a, place[v] = b;
    return place;
  };
  const auto add = [&](const DVec3& from, const DVec3& to) {
    guides.lines.push_back({.from = from, .to = to, .color = kBoxColor, .opacity = kGridOpacity, .width_px = 1});
  };
  for (const double a : multiples(along.x, along.y, step)) add(at(a, across.x), at(a, across.y));
  for (const double b : multiples(across.x, across.y, step)) add(at(along.x, b), at(along.y, b));
  guides.labels.push_back({at(along.y, across.y), "squares of " + lengthText(step, unit)});
}

}  // namespace

GuideConfig guidesNamed(std::string_view names, std::string_view option) {
  GuideConfig config;
  while (!names.empty()) {
    const std::string_view name = names.substr(0, names.find(','));
    const auto* const found = std::ranges::find(kGuides, name, [](const auto& guide) { return guide.first; });
    if (found == kGuides.end())
      throw UsageError("{}: '{}' is none of box, axes, grid and compass, separated by commas", option, name);
    config.*found->second = true;
    names.remove_prefix(std::min(name.size() + 1, names.size()));
  }
  return config;
}

Guides guidesOf(const Model& model, UpAxis up, LengthUnit unit, const GuideConfig& config) {
  Guides guides;
  const Bounds box = model.shownBounds();
  if (!(box.longestSide() > 0)) return guides;
  if (config.grid) addGrid(guides, box, up, unit, model.cloud.origin);
  if (config.box) addBox(guides, box, unit);
  if (config.axes) addAxes(guides, box, model.cloud.origin);
  return guides;
}

Guides compassOf(const Camera& camera, const UVec2& size_px) {
  constexpr double kLength = 0.05, kText = 1.35;  // heights of the picture; of a letter, in lengths
  const DVec2 kMiddle(0.13, 0.1);                 // beside the window's tools, heights of the picture
  const double height = size_px.y, depth = 2 * camera.nearDepth;
  const DVec3 middle = camera.unproject(kMiddle * height, depth, DVec2(size_px));
  const double length = kLength * height * camera.pixelSize(depth, size_px.y);
  Guides guides;
  for (int axis = 0; axis < 3; ++axis) {
    DVec3 way(0);
    way[axis] = length;
    guides.lines.push_back(
        {.from = middle, .to = middle + way, .color = kAxisColors[static_cast<std::size_t>(axis)], .width_px = 2.5});
    guides.labels.push_back({middle + kText * way, std::string(1, "xyz"[axis])});
  }
  return guides;
}

std::shared_ptr<const std::vector<SpaceLine>> PictureGuides::linesWith(const std::vector<SpaceLine>& lines,
                                                                       const Camera& camera,
                                                                       const UVec2& size_px) const {
  auto all = std::make_shared<std::vector<SpaceLine>>(lines);
  all->insert(all->end(), still_.lines.begin(), still_.lines.end());
  if (compass_) std::ranges::copy(compassOf(camera, size_px).lines, std::back_inserter(*all));
  if (all->empty()) return nullptr;
  return all;
}

std::vector<PictureLabel> PictureGuides::labelsIn(const Camera& camera, const UVec2& size_px) const {
  std::vector<PictureLabel> all;
  const auto add = [&](const SpaceLabel& label, bool always) {
    const auto at = camera.project(label.at, DVec2(size_px));
    if (!at) return;
    const DVec2 at_px(*at);
    if (at_px.x < 0 || at_px.y < 0 || at_px.x >= size_px.x || at_px.y >= size_px.y) return;
    all.push_back({at_px, label.text, always});
  };
  if (compass_)
    for (const SpaceLabel& label : compassOf(camera, size_px).labels) add(label, true);
  for (const SpaceLabel& label : still_.labels) add(label, false);
  return all;
}

bool LabelRoom::admits(const PictureLabel& label, const DVec2& low_px, const DVec2& high_px) {
  const auto meets = [&](const std::array<DVec2, 2>& other) {
    return glm::all(glm::lessThan(low_px, other[1])) && glm::all(glm::lessThan(other[0], high_px));
  };
  if (!label.always && std::ranges::any_of(reserved_, meets)) return false;
  reserve(low_px, high_px);
  return true;
}

}  // namespace palpate
