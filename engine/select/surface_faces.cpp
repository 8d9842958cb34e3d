#include "engine/select/surface_faces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/core/check.hpp"
#include "engine/core/parallel.hpp"

namespace palpate {

namespace {

constexpr std::size_t kNearest = 24;    // among which neighbours are sought
constexpr std::size_t kForSpacing = 6;  // of these, at least, where there are as many
constexpr std::size_t kMaxListed = 12;  // neighbours that a point finds
constexpr float kSameSheet = -0.3f;     // least cosine between normals
constexpr float kLongest = 3.5f;        // of an edge, spacings
constexpr double kMaxRim = 4;           // by which a rim is wider than its hole, spacings
constexpr std::uint32_t kNobody = ~0u;

using Listed = std::array<std::uint32_t, kMaxListed>;

bool lists(const Listed& listed, std::uint32_t point) { return std::ranges::find(listed, point) != listed.end(); }

// The next ones of the same sheet, nearest first, without the point itself.
class Nearest {
 public:
  Nearest(std::span<const Vec3> positions, std::span<const Vec3> normals, const PointTree& tree)
      : positions_(positions), normals_(normals), tree_(tree) {}

  void find(std::uint32_t point) {
    std::array<double, kNearest + 1> squared{};
    std::array<std::uint32_t, kNearest + 1> near{};
    const std::size_t found = tree_.nearest(positions_[point], near, squared);
    count_ = 0;
    for (std::size_t k = 0; k < found; ++k) {
      if (near[k] == point || glm::dot(normals_[point], normals_[near[k]]) < kSameSheet) continue;
      near_[count_] = near[k];
      offsets_[count_++] = DVec3(positions_[near[k]]) - DVec3(positions_[point]);
    }
  }
  // By the discs through each of them: a single one depends on how the points are arranged.
  float spacing() const {
    const std::size_t first = std::min(kForSpacing, count_);
    double sum = 0;
    for (std::size_t k = first; k <= count_ && k > 0; ++k)
      sum += glm::length(offsets_[k - 1]) * std::sqrt(std::numbers::pi / (static_cast<double>(k) + 0.5));
    return static_cast<float>(sum / static_cast<double>(count_ - first + 1));
  }
  // A point in the ball over a diameter is nearer than its other end.
  Listed neighbours() const {
    Listed listed;
    listed.fill(kNobody);
    std::size_t count = 0;
    for (std::size_t j = 0; j < count_ && count < listed.size(); ++j) {
      bool isFree = true;
      for (std::size_t k = 0; k < j && isFree; ++k) isFree = glm::dot(offsets_[k], offsets_[j] - offsets_[k]) < 0;
      if (isFree) listed[count++] = near_[j];
    }
    return listed;
  }

 private:
  std::span<const Vec3> positions_, normals_;
  const PointTree& tree_;
  std::size_t count_ = 0;
  std::array<std::uint32_t, kNearest> near_{};
  std::array<DVec3, kNearest> offsets_{};
};

}  // namespace

SurfaceFaces::SurfaceFaces(std::span<const Vec3> positions, std::span<const Vec3> normals, const PointTree& tree,
                           unsigned threads)
    : positions_(positions), normals_(normals), spacings_(positions.size()), begins_(positions.size() + 1) {
  const std::size_t count = positions.size();
  std::vector<Listed> listed(count);
  parallelFor(count, threads, [&](std::size_t begin, std::size_t end) {
    Nearest nearest(positions, normals, tree);
    for (std::size_t i = begin; i < end; ++i) {
      nearest.find(static_cast<std::uint32_t>(i));
      spacings_[i] = nearest.spacing();
      listed[i] = nearest.neighbours();
    }
  });
  // Each edge once, by the one that lists it, or by the lower number if both do.
  const auto forEachEdge = [&](auto&& use) {
    for (std::uint32_t i = 0; i < count; ++i)
      for (const std::uint32_t j : listed[i]) {
        if (j == kNobody) break;
        if (j < i && lists(listed[j], i)) continue;
        if (glm::distance(positions[i], positions[j]) <= kLongest * std::min(spacings_[i], spacings_[j])) use(i, j);
      }
  };
  forEachEdge([&](std::uint32_t i, std::uint32_t j) { ++begins_[i + 1], ++begins_[j + 1]; });
  for (std::size_t i = 0; i < count; ++i) begins_[i + 1] += begins_[i];
  neighbours_.resize(begins_.back());
  std::vector<std::size_t> next(begins_.begin(), begins_.end() - 1);
  forEachEdge([&](std::uint32_t i, std::uint32_t j) { neighbours_[next[i]++] = j, neighbours_[next[j]++] = i; });
  parallelFor(count, threads, [&](std::size_t begin, std::size_t end) {
    std::vector<std::pair<double, std::uint32_t>> angles;
    for (std::size_t i = begin; i < end; ++i) {
      const Frame3 frame = frameAround(DVec3(normals[i]));
      angles.clear();
      for (const std::uint32_t j : neighboursOf(static_cast<std::uint32_t>(i))) {
        const DVec3 offset = DVec3(positions[j]) - DVec3(positions[i]);
        angles.emplace_back(std::atan2(glm::dot(offset, frame.v), glm::dot(offset, frame.u)), j);
      }
      std::ranges::sort(angles);
      for (std::size_t k = 0; k < angles.size(); ++k) neighbours_[begins_[i] + k] = angles[k].second;
    }
  });
}

std::size_t SurfaceFaces::halfEdge(std::uint32_t from, std::uint32_t to) const {
  const auto around = neighboursOf(from);
  return begins_[from] + static_cast<std::size_t>(std::ranges::find(around, to) - around.begin());
}

// The half-edge of the same face, which is on its left.
std::size_t SurfaceFaces::after(std::uint32_t from, std::uint32_t to) const {
  const std::size_t back = halfEdge(to, from);
  return back > begins_[to] ? back - 1 : begins_[to + 1] - 1;
}

// Of the points next to the rim: those of the rim lack neighbours in the hole.
double SurfaceFaces::spacingAround(std::span<const std::uint32_t> rim) const {
  std::vector<std::uint32_t> sorted(rim.begin(), rim.end());
  std::ranges::sort(sorted);
  double around = 0, on = 0;
  std::size_t count = 0;
  for (const std::uint32_t each : rim) {
    on += spacingOf(each);
    for (const std::uint32_t next : neighboursOf(each))
      if (!std::ranges::binary_search(sorted, next)) around += spacingOf(next), ++count;
  }
  return count > 0 ? around / static_cast<double>(count) : on / static_cast<double>(rim.size());
}

double SurfaceFaces::widthOf(const Face& face) const {
  const Frame3 frame = frameAround(glm::normalize(face.area));
  std::vector<DVec2> corners;
  DVec3 first(positions_[face.rim.front()]);
  double across = 0;
  for (const std::uint32_t each : face.rim) {
    throwIfStopWanted();
    const DVec3 offset = DVec3(positions_[each]) - first;
    corners.emplace_back(glm::dot(offset, frame.u), glm::dot(offset, frame.v));
    for (const std::uint32_t other : face.rim)
      across = std::max(across, glm::distance(DVec3(positions_[each]), DVec3(positions_[other])));
  }
  double area = 0, xx = 0, yy = 0, xy = 0;
  DVec2 middle(0);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const DVec2 p = corners[i], q = corners[(i + 1) % corners.size()];
    const double twice = p.x * q.y - q.x * p.y;
    area += twice / 2;
    middle += twice / 6 * (p + q);
    xx += twice / 12 * (p.x * p.x + p.x * q.x + q.x * q.x);
    yy += twice / 12 * (p.y * p.y + p.y * q.y + q.y * q.y);
    xy += twice / 24 * (p.x * q.y + 2 * p.x * p.y + 2 * q.x * q.y + q.x * p.y);
  }
  middle /= area;
  xx = xx / area - middle.x * middle.x, yy = yy / area - middle.y * middle.y, xy = xy / area - middle.x * middle.y;
  const double largest = (xx + yy) / 2 + std::hypot((xx - yy) / 2, xy);
  const double spacing = spacingAround(face.rim), point = spacing * spacing;
  const double missing = std::max(0.0, area - point * (static_cast<double>(corners.size()) / 2 - 1));
  const double longAxis = 4 * std::sqrt(std::max(0.0, largest) * missing / area);
  constexpr double kRound = 0.93;  // so that chance hardly makes a hole wider than it is
  return std::max(kRound * longAxis, across - kMaxRim * spacing);
}

SurfaceFaces::Holes SurfaceFaces::holes(double widest) const {
  constexpr double kLargeShare = 0.02;               // of the faces, that may be holes or what is next to them
  constexpr double kOverOthers = 4, kMinArea = 4.5;  // of the others; of the area of a point
  struct Candidate {
    Face face;
    double area;   // in areas of a point
    double width;  // at least, from the first point of the rim
  };
  std::vector<Candidate> large;
  std::vector<float> areas;  // of those that may be narrow enough, in areas of a point
  std::vector<std::uint8_t> isVisited(neighbours_.size());
  Face face;
  for (std::uint32_t first = 0; first + 1 < begins_.size(); ++first)
    for (std::size_t begin = begins_[first]; begin < begins_[first + 1]; ++begin) {
      if (isVisited[begin]) continue;
      face.rim.clear();
      face.area = DVec3(0);
      DVec3 normals(0);
      double spacings = 0, farthest = 0;
      std::uint32_t from = first;
      std::size_t at = begin;
      do {
        isVisited[at] = 1;
        const std::uint32_t to = neighbours_[at];
        const DVec3 offset = DVec3(positions_[from]) - DVec3(positions_[first]);
        farthest = std::max(farthest, glm::dot(offset, offset));
        face.rim.push_back(from);
        face.area += 0.5 * glm::cross(offset, DVec3(positions_[to]) - DVec3(positions_[first]));
        normals += DVec3(normals_[from]);
        spacings += spacingOf(from);
        at = after(from, to);
        from = to;
      } while (at != begin);
      if (face.rim.size() < 3 || glm::dot(face.area, normals) <= 0) continue;
      const double spacing = spacings / static_cast<double>(face.rim.size());
      const auto area = static_cast<float>(glm::length(face.area) / (spacing * spacing));
      if (farthest <= widest * widest) areas.push_back(area);
      if (area >= kMinArea) large.push_back({face, static_cast<double>(area), std::sqrt(farthest) - kMaxRim * spacing});
    }
  double least = kMinArea;
  if (!areas.empty()) {
    const auto usual =
        areas.begin() + static_cast<std::ptrdiff_t>((1 - kLargeShare) * static_cast<double>(areas.size()));
    std::ranges::nth_element(areas, std::min(usual, areas.end() - 1));
    least = std::max(kMinArea, kOverOthers * static_cast<double>(*std::min(usual, areas.end() - 1)));
  }
  Holes holes;
  for (Candidate& each : large) {
    if (each.area < least) continue;
    // A rim whose first point alone makes it wider than the narrowest one is not measured.
    const bool isMeasured = holes.wider == 0 || each.width < holes.narrowest || each.width <= widest;
    const double width = isMeasured ? widthOf(each.face) : each.width;
    if (width <= widest) {
      holes.fitting.push_back(std::move(each.face));
    } else {
      holes.narrowest = holes.wider++ == 0 ? width : std::min(holes.narrowest, width);
    }
  }
  return holes;
}

}  // namespace palpate
