#include "engine/edit/resample_neighbours.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "engine/core/widest_lanes.hpp"
#include "shaders/shared/brush.h"

namespace palpate {

namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

struct Offsets {
  const double *x, *y, *z;
};
struct Normals {
  const float *x, *y, *z;
};
struct Surveyed {
  double *squared, *gap;
  std::uint32_t* sector;
};

// gap: squared distance of a neighbour of the same sheet, otherwise infinity.
PALPATE_WIDEST_LANES
void surveyEach(std::size_t count, const Offsets& offsets, const Normals& normals, const Frame3& frame,
                const Surveyed& surveyed) {
  const double *x = offsets.x, *y = offsets.y, *z = offsets.z;
  const float *nx = normals.x, *ny = normals.y, *nz = normals.z;
  double *squared = surveyed.squared, *gap = surveyed.gap;
  std::uint32_t* sector = surveyed.sector;
  const double ux = frame.u.x, uy = frame.u.y, uz = frame.u.z, vx = frame.v.x, vy = frame.v.y, vz = frame.v.z;
  const double wx = frame.n.x, wy = frame.n.y, wz = frame.n.z;
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) {
    const double far = x[k] * x[k] + y[k] * y[k] + z[k] * z[k];
    const double normalX = double{nx[k]}, normalY = double{ny[k]}, normalZ = double{nz[k]};
    const double cosine = normalX * wx + normalY * wy + normalZ * wz;
    squared[k] = far;
    gap[k] = cosine > static_cast<double>(shared::kSameSheet) ? far : kFar;
  }
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k)
    sector[k] = shared::sectorOf(static_cast<float>(x[k] * ux + y[k] * uy + z[k] * uz),
                                 static_cast<float>(x[k] * vx + y[k] * vy + z[k] * vz));
}

// Doubles that are not negative have the order of their bits, whose minimum processors find in several lanes.
struct LeastBits {
  std::int64_t squared;
  std::array<std::int64_t, shared::kGapSectors> gaps;
};

PALPATE_WIDEST_LANES
void findLeast(std::size_t count, const Surveyed& surveyed, LeastBits& least) {
  const double *squared = surveyed.squared, *gap = surveyed.gap;
  const std::uint32_t* sector = surveyed.sector;
  constexpr auto kNone = std::bit_cast<std::int64_t>(kFar);
  std::int64_t nearest = kNone, a = kNone, b = kNone, c = kNone, d = kNone, e = kNone, f = kNone;
  static_assert(shared::kGapSectors == 6);
  for (std::size_t k = 0; k < count; ++k) {
    const auto any = std::bit_cast<std::int64_t>(squared[k]), bits = std::bit_cast<std::int64_t>(gap[k]);
    const std::uint64_t in = sector[k];
    // Any bits combined with those of infinity are not less than infinity, so that other sectors never win.
    const auto ifIn = [&](std::uint64_t wanted) { return bits | (in == wanted ? std::int64_t{0} : kNone); };
    const std::int64_t inA = ifIn(0), inB = ifIn(1), inC = ifIn(2), inD = ifIn(3), inE = ifIn(4), inF = ifIn(5);
    nearest = nearest < any ? nearest : any;
    a = a < inA ? a : inA;
    b = b < inB ? b : inB;
    c = c < inC ? c : inC;
    d = d < inD ? d : inD;
    e = e < inE ? e : inE;
    f = f < inF ? f : inF;
  }
  least = {nearest, {a, b, c, d, e, f}};
}

}  // namespace

ResampleNeighbours::ResampleNeighbours(std::span<const ResampleNeighbour> neighbours) {
  makeRoom(neighbours.size());
  std::ranges::copy(neighbours, points_.begin());
  std::ranges::fill(isSeen_, 1);
  std::vector<DVec3> offsets;
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    offsets.push_back(neighbours[i].offset);
    nearX_[i] = static_cast<float>(neighbours[i].normal.x);
    nearY_[i] = static_cast<float>(neighbours[i].normal.y);
    nearZ_[i] = static_cast<float>(neighbours[i].normal.z);
  }
  near_ = NearPoints(offsets);
}

void ResampleNeighbours::makeRoom(std::size_t points) {
  if (points_.size() >= points) return;
  const std::size_t room = 2 * points;
  for (std::vector<float>* each : {&normalX_, &normalY_, &normalZ_, &nearX_, &nearY_, &nearZ_}) each->resize(room);
  for (std::vector<double>* each : {&squared_, &gap_}) each->resize(room);
  sectors_.resize(room);
  points_.resize(room);
  isSeen_.resize(room);
}

void ResampleNeighbours::gather(const GatheredPoints& points, std::span<const Vec3> normals, Seen seen) {
  const std::span<const std::uint32_t> numbers = points.numbers();
  gathered_ = &points;
  seen_ = std::move(seen);
  makeRoom(numbers.size());
  std::fill_n(isSeen_.begin(), numbers.size(), 0);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const Vec3& normal = normals[numbers[i]];
    normalX_[i] = normal.x;
    normalY_[i] = normal.y;
    normalZ_[i] = normal.z;
  }
}

bool ResampleNeighbours::look(const Self& self, std::span<const std::uint32_t> among, std::size_t most) {
  gathered_->near(self.place, self.radius, among, self.number, near_);
  const bool complete = size() <= most;
  near_.truncate(most);
  for (std::size_t k = 0; k < size(); ++k) {
    const std::uint32_t i = near_.indices()[k];
    nearX_[k] = normalX_[i];
    nearY_[k] = normalY_[i];
    nearZ_[k] = normalZ_[i];
  }
  return complete;
}

const ResampleNeighbour& ResampleNeighbours::point(std::uint32_t index) const {
  if (std::exchange(isSeen_[index], 1) == 0) points_[index] = seen_(gathered_->numbers()[index]);
  return points_[index];
}

ResampleNeighbour ResampleNeighbours::operator[](std::size_t k) const {
  ResampleNeighbour neighbour = point(near_.indices()[k]);
  neighbour.offset = {near_.x()[k], near_.y()[k], near_.z()[k]};
  return neighbour;
}

ResampleNeighbours::Survey ResampleNeighbours::survey(const Frame3& frame) {
  const Surveyed surveyed{squared_.data(), gap_.data(), sectors_.data()};
  Survey survey;
  surveyEach(size(), {near_.x(), near_.y(), near_.z()}, {nearX_.data(), nearY_.data(), nearZ_.data()}, frame, surveyed);
  LeastBits least;
  findLeast(size(), surveyed, least);
  survey.nearest = std::bit_cast<double>(least.squared);
  // The root is monotonic: that of the least square is the least distance.
  for (std::size_t sector = 0; sector < survey.gaps.size(); ++sector)
    survey.gaps[sector] = std::sqrt(std::bit_cast<double>(least.gaps[sector]));
  return survey;
}

std::size_t ResampleNeighbours::atGap(std::size_t sector, double distance) const {
  std::optional<std::size_t> found;
  for (std::size_t k = 0; k < size(); ++k) {
    if (sectors_[k] != sector || std::sqrt(gap_[k]) != distance) continue;
    if (!found || (*this)[k].number < (*this)[*found].number) found = k;
  }
  return found.value();
}

}  // namespace palpate
