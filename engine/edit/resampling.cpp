#include "engine/edit/resampling.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "shaders/shared/brush.h"

namespace palpate {

namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

bool sameSheet(const DVec3& normal, const DVec3& other) {
  return glm::dot(normal, other) > static_cast<double>(shared::kSameSheet);
}

// New points keep the distance of the wider target, points of the file that of the narrower one, and relative to their
// distance as loaded.
bool crowd(const ResampleNeighbour& a, const ResampleNeighbour& b) {
  const bool anyNew = a.isNew || b.isNew;
  const double least = std::min(a.spacing, b.spacing);
  const double closest = static_cast<double>(shared::kCrowded) * (anyNew ? std::max(a.spacing, b.spacing) : least);
  const double distance = glm::distance(a.offset, b.offset);
  if (distance >= closest || !sameSheet(a.normal, b.normal)) return false;
  const double before = glm::distance(a.rest, b.rest);
  return anyNew || distance < static_cast<double>(shared::kComeNearer) * before ||
         before < static_cast<double>(shared::kSamePlace) * least;
}

// Whether an edit has moved two points relative to each other.
bool torn(const ResampleNeighbour& a, const ResampleNeighbour& b) {
  const DVec3 moved = (b.offset - a.offset) - (b.rest - a.rest);
  return glm::length(moved) > static_cast<double>(shared::kTorn) * std::max(a.spacing, b.spacing);
}

// Whether a gap may be filled, by what the last stroke found of its ends, if a stroke has moved any.
bool mayBeFilled(const ResampleNeighbour& self, const ResampleNeighbour& other, const ResampleView& view) {
  const std::uint32_t last = std::max(self.stroke, other.stroke);
  if (last == 0) return true;
  const auto at = [&](const ResampleNeighbour& point) {
    return point.stroke == last ? point.found : view.place + point.offset;
  };
  const auto facing = [&](const ResampleNeighbour& point) {
    return point.stroke == last ? point.foundNormal : point.normal;
  };
  const shared::GapAsFoundOf<double> found{other.rest - self.rest, at(other) - at(self), facing(self), facing(other)};
  return shared::areOneSide(found) &&
         (view.carves || shared::hasOpened(found, other.offset, std::max(self.spacing, other.spacing)));
}

// Of two crowding points, the one of the smaller rank stays.
auto rank(const ResampleNeighbour& point) { return std::tuple(point.unsettled, point.number); }

bool hasToYield(const ResampleNeighbour& point, const ResampleNeighbour& other) {
  return rank(other) < rank(point) && crowd(point, other);
}

template <class Holds>
bool anyOf(const ResampleNeighbours& neighbours, Holds&& holds) {
  for (std::size_t i = 0; i < neighbours.size(); ++i)
    if (holds(neighbours[i])) return true;
  return false;
}

bool facesAway(const ResampleNeighbour& a, const ResampleNeighbour& b) {
  return glm::dot(a.normal, b.normal) <= static_cast<double>(shared::kFarSheet);
}

// Thresholds for removing a point, and lower ones for rejecting a new one.
struct Outside {
  float margin;
  double share;
};
const Outside kGoes{0, shared::kNearlyAll}, kStaysAway{shared::kBirthMargin, shared::kHalfOfThem};

// Whether a position near `self` is through the far sheet of a plate.
bool standsThrough(const ResampleNeighbour& self, const DVec3& place, const ResampleNeighbours& neighbours,
                   float margin) {
  return anyOf(neighbours, [&](const ResampleNeighbour& other) {
    return facesAway(self, other) &&
           shared::isThrough(Vec3(place - other.offset), Vec3(other.normal), static_cast<float>(self.spacing), margin);
  });
}

// Whether a position has risen over the points at rest around it.
bool hasRisen(const ResampleNeighbour& self, const DVec3& place, const ResampleNeighbours& neighbours,
              const Outside& outside) {
  double all = 0, above = 0;
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    const ResampleNeighbour other = neighbours[i];
    const DVec3 offset = place - other.offset;
    const double distance = glm::length(offset);
    if (!other.atRest || facesAway(self, other) || distance == 0) continue;
    const double weight = std::pow(self.spacing / distance, 4);
    all += weight;
    if (shared::isAbove(Vec3(offset), Vec3(other.normal), static_cast<float>(self.spacing), outside.margin))
      above += weight;
  }
  return above > outside.share * all;
}

bool standsOutside(const ResampleNeighbour& self, const DVec3& place, const ResampleNeighbours& neighbours,
                   const Outside& outside) {
  return standsThrough(self, place, neighbours, outside.margin) || hasRisen(self, place, neighbours, outside);
}

// Depth of the nearest point of a far sheet under the point as the stroke found it.
std::optional<double> thicknessSeen(const ResampleNeighbour& self, const ResampleView& view) {
  std::optional<double> least;
  for (std::size_t i = 0; i < view.neighbours.size(); ++i) {
    const ResampleNeighbour other = view.neighbours[i];
    if (glm::dot(other.normal, view.foundNormal) > static_cast<double>(shared::kFarSheet)) continue;
    const double along = glm::dot(other.offset, view.foundNormal);
    const DVec3 aside = other.offset - along * view.foundNormal;
    const double deep = glm::dot(view.found, view.foundNormal) - along;
    if (deep > 0 && glm::length(aside) < static_cast<double>(shared::kBeside) * self.spacing)
      least = std::min(least.value_or(deep), deep);
  }
  return least;
}

// The lowest-ranked of the neighbours that crowd a point and rank before it. `widest`: no spacing is wider.
std::optional<ResampleNeighbour> firstToCrowd(const ResampleNeighbour& self, const ResampleNeighbours::Survey& survey,
                                              const ResampleNeighbours& neighbours, double widest) {
  // Most are too far away for any spacing; the margin covers the rounding of the square.
  constexpr double kMargin = 1e-9;
  const double farthest = static_cast<double>(shared::kCrowded) * std::max(self.spacing, widest);
  const double most = farthest * farthest * (1 + kMargin);
  if (survey.nearest > most) return {};
  const double* const squared = neighbours.squaredDistances();
  std::optional<ResampleNeighbour> first;
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    if (squared[i] > most) continue;
    const ResampleNeighbour other = neighbours[i];
    if (hasToYield(self, other) && (!first || rank(other) < rank(*first))) first = other;
  }
  return first;
}

}  // namespace

double sectorSpacing(SectorDistances distances) {
  std::ranges::sort(distances);
  const auto there = static_cast<std::size_t>(std::ranges::find(distances, kFar) - distances.begin());
  return there == 0 ? 0 : distances[there / 2] / static_cast<double>(shared::kSectorSpacings);
}

ResampleRequest resampleRequest(const ResampleNeighbour& self, const ResampleView& view) {
  ResampleNeighbours& neighbours = view.neighbours;
  ResampleRequest request;
  if (view.carves) {
    request.room = thicknessSeen(self, view);
    const double deep = glm::dot(view.found, view.foundNormal);
    const double least = request.room.value_or(view.room) - static_cast<double>(shared::kSkin) * self.spacing;
    if (view.moved && (deep > least || standsOutside(self, DVec3(0), neighbours, kGoes))) return {.goes = true};
  }
  const ResampleNeighbours::Survey survey = neighbours.survey(frameAround(self.normal));
  if (const std::optional<ResampleNeighbour> first = firstToCrowd(self, survey, neighbours, view.widest)) {
    const auto firstYieldsTo = [&](const ResampleNeighbour& third) { return hasToYield(*first, third); };
    // A settled point stays.
    if (!first->unsettled || !anyOf(neighbours, firstYieldsTo)) return {.goes = true};
    request.unsettled = true;
  }

  if (!view.fills) return request;
  double narrowest = kFar;
  for (std::size_t sector = 0; sector < shared::kGapSectors; ++sector) {
    const double gap = survey.gaps[sector];
    if (gap == kFar || gap >= narrowest || gap <= static_cast<double>(shared::kWidestGap) * self.spacing) continue;
    const ResampleNeighbour other = neighbours[neighbours.atGap(sector, gap)];
    const double spacing = std::max(self.spacing, other.spacing);
    if (gap <= static_cast<double>(shared::kWidestGap) * spacing || !torn(self, other)) continue;
    if (!mayBeFilled(self, other, view)) continue;
    const DVec3 place = shared::halfWay(other.offset, self.normal, other.normal);
    if (glm::length(place) > view.reach) continue;
    if (view.claims && view.claims->wasGranted(Vec3(view.place + place))) continue;
    const double clearance = static_cast<double>(shared::kMinClearance) * spacing;
    // The new point must not crowd one with a wider target, nor one of another sheet that may turn out to be the same:
    // it would be removed again.
    const DVec3 facing = self.normal + other.normal;
    const auto blocks = [&](const ResampleNeighbour& point) {
      const double distance = glm::distance(point.offset, place);
      if (distance < clearance && sameSheet(self.normal, point.normal)) return true;
      return distance < static_cast<double>(shared::kCrowded) * std::max(spacing, point.spacing) &&
             glm::dot(facing, point.normal) > static_cast<double>(shared::kFarSheet) * glm::length(facing);
    };
    if (blocks(self) || anyOf(neighbours, blocks)) continue;
    if (view.carves && standsOutside(self, place, neighbours, kStaysAway)) continue;
    narrowest = gap;
    request.inserts = request.unsettled = true;
    request.offset = place;
    request.other = other.number;
    request.takesAfterOther = other.spacing > self.spacing;
  }
  return request;
}

InsertionClaims::InsertionClaims(double spacing)
    : grid_(shared::claimGrid(static_cast<float>(spacing))),
      clearance_(shared::kMinClearance * static_cast<float>(spacing)),
      slots_(shared::kClaimSlots),
      granted_(shared::kClaimSlots) {}

void InsertionClaims::begin(std::uint32_t stroke) {
  stroke_ = stroke;
  for (const std::uint32_t slot : claimed_) slots_[slot] = {};
  claimed_.clear();
}

bool InsertionClaims::wasGranted(const Vec3& place) const {
  const Granted& granted = granted_[slotOf(cellOf(grid_, place))];
  return granted.stroke == stroke_ && granted.place == place;
}

void InsertionClaims::grant(const Vec3& place) { granted_[slotOf(cellOf(grid_, place))] = {place, stroke_}; }

void InsertionClaims::claim(const Vec3& place, std::uint32_t number) {
  claimed_.push_back(slotOf(cellOf(grid_, place)));
  Slot& slot = slots_[claimed_.back()];
  slot.number = std::min(slot.number, number);
}

void InsertionClaims::confirm(const Vec3& place, std::uint32_t number) {
  Slot& slot = slots_[slotOf(cellOf(grid_, place))];
  if (slot.number == number) slot.place = place;
}

bool InsertionClaims::stands(const Vec3& place, std::uint32_t number) const {
  const IVec3 cell = cellOf(grid_, place);
  if (slots_[slotOf(cell)].number != number) return false;
  for (int z = -1; z <= 1; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x) {
        const Slot& slot = slots_[slotOf(cell + IVec3(x, y, z))];
        if (slot.number < number && glm::distance(slot.place, place) < clearance_) return false;
      }
  return true;
}

}  // namespace palpate
