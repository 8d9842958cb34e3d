#include "engine/cloud/edited_gaussians.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numeric>
#include <unordered_map>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/cloud/eigen3.hpp"
#include "engine/cloud/gaussian_columns.hpp"
#include "engine/cloud/point_tree.hpp"
#include "engine/cloud/shortest_rotation.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/core/check.hpp"
#include "engine/core/parallel_collect.hpp"
#include "engine/core/vec.hpp"

#include <glm/matrix.hpp>

namespace palpate {

namespace {

/// position = scale * (rotation * position before), about the means.
struct Similarity {
  DQuat rotation{1, 0, 0, 0};
  double scale = 1;
  double misfit = 0;  ///< root mean square of what is left, in radii (the same mean) of the points
};

using Matrix4 = std::array<std::array<double, 4>, 4>;

/// The eigenvector of a symmetric matrix with the largest eigenvalue, by cyclic Jacobi rotations.
std::array<double, 4> largestVector(Matrix4 m) {
  Matrix4 vectors{};
  for (std::size_t k = 0; k < 4; ++k) vectors[k][k] = 1;
  for (int sweep = 0; sweep < kMaxJacobiSweeps; ++sweep)
    for (std::size_t p = 0; p < 4; ++p)
      for (std::size_t q = p + 1; q < 4; ++q) {
        if (m[p][q] == 0) continue;
        const auto [t, c, s] = jacobiRotation(m[p][p], m[q][q], m[p][q]);
        for (std::size_t k = 0; k < 4; ++k) {
          const double a = m[k][p], b = m[k][q];
          m[k][p] = c * a - s * b, m[k][q] = s * a + c * b;
        }
        for (std::size_t k = 0; k < 4; ++k) {
          const double a = m[p][k], b = m[q][k];
          m[p][k] = c * a - s * b, m[q][k] = s * a + c * b;
          const double u = vectors[k][p], v = vectors[k][q];
          vectors[k][p] = c * u - s * v, vectors[k][q] = s * u + c * v;
        }
        m[p][q] = m[q][p] = 0;
      }
  std::size_t largest = 0;
  for (std::size_t k = 1; k < 4; ++k)
    if (m[k][k] > m[largest][largest]) largest = k;
  return {vectors[0][largest], vectors[1][largest], vectors[2][largest], vectors[3][largest]};
}

DVec3 meanOf(std::span<const DVec3> points) {
  return std::accumulate(points.begin(), points.end(), DVec3(0)) / static_cast<double>(points.size());
}

/// The similarity that takes points nearest to others, one for each (Horn 1987, "Closed-form solution of absolute
/// orientation using unit quaternions"). At least three, not on a line.
Similarity nearestSimilarity(std::span<const DVec3> before, std::span<const DVec3> now) {
  PALPATE_CHECK_EQ(before.size(), now.size());
  const DVec3 meanBefore = meanOf(before), meanNow = meanOf(now);
  glm::dmat3 s(0);  // s[j][i]: sum of coordinate i before times coordinate j now
  double squaresBefore = 0, squaresNow = 0;
  for (std::size_t k = 0; k < before.size(); ++k) {
    const DVec3 a = before[k] - meanBefore, b = now[k] - meanNow;
    s += glm::outerProduct(a, b);
    squaresBefore += glm::dot(a, a), squaresNow += glm::dot(b, b);
  }
  if (!(squaresBefore > 0 && squaresNow > 0)) return {};
  const auto at = [&](int i, int j) { return s[j][i]; };
  const double xx = at(0, 0), yy = at(1, 1), zz = at(2, 2), x = at(1, 2) - at(2, 1), y = at(2, 0) - at(0, 2),
               z = at(0, 1) - at(1, 0), xy = at(0, 1) + at(1, 0), yz = at(1, 2) + at(2, 1), zx = at(2, 0) + at(0, 2);
  const auto q = largestVector(
      {{{xx + yy + zz, x, y, z}, {x, xx - yy - zz, xy, zx}, {y, xy, yy - xx - zz, yz}, {z, zx, yz, zz - xx - yy}}});
  Similarity found{.rotation = glm::normalize(DQuat(q[0], q[1], q[2], q[3])),
                   .scale = std::sqrt(squaresNow / squaresBefore)};
  double left = 0;
  for (std::size_t k = 0; k < before.size(); ++k) {
    const DVec3 off = now[k] - meanNow - found.scale * (found.rotation * (before[k] - meanBefore));
    left += glm::dot(off, off);
  }
  found.misfit = std::sqrt(left / squaresNow);
  return found;
}

constexpr double kReach = 4;           // in spacings: the support radius, from which a hand feels a point
constexpr double kAround = 2;          // in distances to the nearest point
constexpr std::size_t kSample = 2048;  // points that are looked at for a Gaussian off the surface

GaussianOwner ownerIn(const PointTree& tree, const Vec3& center, double spacing) {
  GaussianOwner owner;
  double squared = 0;
  if (!isFinite(center) || tree.nearest(center, {&owner.point, 1}, {&squared, 1}) == 0) return {};
  owner.distance = std::sqrt(squared);
  owner.isNear = owner.distance <= kReach * spacing;
  return owner;
}

/// Of a few points around one, on the same side of the surface: the farthest, and the one with which it spans most.
void addBeside(const PointCloud& file, const PointTree& tree, GaussianOwner& owner) {
  constexpr std::size_t kNeighbours = 8;
  constexpr float kSameSide = 0.5f, kMinSine = 0.2f;
  std::array<std::uint32_t, kNeighbours> near;
  std::array<double, kNeighbours> squared;
  const std::uint32_t point = owner.point;
  const Vec3 at = file.positions[point];
  Vec3 first(0);
  float widest = 0;
  for (std::size_t k = tree.nearest(at, near, squared); k-- > 1;) {
    if (near[k] == point) continue;
    if (file.hasNormals() && glm::dot(file.normals[near[k]], file.normals[point]) <= kSameSide) continue;
    const Vec3 way = file.positions[near[k]] - at;
    if (owner.beside == GaussianOwner::kNone) {
      owner.beside = near[k];
      first = way;
      widest = kMinSine * glm::dot(way, way);
    } else if (const float span = glm::length(glm::cross(first, way)); span > widest) {
      owner.across = near[k];
      widest = span;
    }
  }
}

struct Owner : GaussianOwner {
  bool isGone = false;
};

class GaussianEdit {
 public:
  GaussianEdit(const PointCloud& file, const GaussianRecords& records, std::span<const PointState> points,
               unsigned threads)
      : file_(file),
        records_(records),
        columns_(records),
        points_(points),
        threads_(threads),
        spacing_(meanSpacing(file, threads)),
        isAnyGone_(std::ranges::any_of(points.first(file.size()), &PointState::gone)),
        tree_(file.positions, threads_),
        owners_(parallelMake(records.size(), threads, [&](std::size_t i) { return ownerOf(i); })) {}

  std::shared_ptr<const GaussianRecords> result() const {
    const auto kept = parallelCollect(
        records_.size(), threads_, [&](std::size_t i) { return !owners_[i].isGone; }, [](std::size_t i) { return i; });
    BareVector<std::byte> rows(kept.size() * records_.rowBytes);
    parallelFor(kept.size(), threads_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        std::byte* const row = rows.data() + k * records_.rowBytes;
        std::memcpy(row, records_.row(kept[k]), records_.rowBytes);
        if (owners_[kept[k]].isNear) follow(owners_[kept[k]].point, row);
      }
    });
    appendNew(rows);
    return std::make_shared<const GaussianRecords>(records_.columns, std::move(rows));
  }

 private:
  Vec3 relativeCenter(std::size_t i) const { return Vec3(columns_.center(records_.row(i)) - file_.origin); }
  DVec3 inFile(std::size_t point) const { return file_.origin + DVec3(file_.positions[point]); }
  DVec3 present(std::size_t point) const { return file_.origin + DVec3(points_[point].position); }

  Owner ownerOf(std::size_t i) const {
    const Vec3 center = relativeCenter(i);
    Owner owner{ownerIn(tree_, center, spacing_)};
    if (!isAnyGone_ || owner.point == GaussianOwner::kNone) return owner;
    owner.isGone = owner.isNear ? points_[owner.point].gone : areMostGone(center, owner.distance, owner.point);
    return owner;
  }

  bool areMostGone(const Vec3& center, double distance, std::uint32_t nearest) const {
    const auto around2 = static_cast<float>(kAround * kAround * distance * distance);
    const std::size_t step = (file_.size() + kSample - 1) / kSample;
    std::size_t around = 0, gone = 0;
    for (std::size_t i = 0; i < file_.size(); i += step) {
      const Vec3 to = file_.positions[i] - center;
      if (glm::dot(to, to) > around2) continue;
      ++around;
      gone += points_[i].gone ? 1 : 0;
    }
    return around == 0 ? points_[nearest].gone : 2 * gone > around;
  }

  void follow(std::uint32_t point, std::byte* row) const {
    const PointState& state = points_[point];
    if (hasMoved(point)) columns_.move(row, motionAt(point, columns_.center(row)));
    if (state.color != packedColor(file_, point)) columns_.paint(row, unpackedColor(state.color));
  }

  bool hasMoved(std::uint32_t point) const { return points_[point].position != file_.positions[point]; }

  /// How a Gaussian moves with its point: as the nearest points that have moved, if these keep their shape. Else it
  /// moves as the point, and rotates as all neighbours do if the surface bends smoothly there, but about its own
  /// centre: one off the surface would swing far. At the border of what was moved it keeps to its normal.
  GaussianMotion motionAt(std::uint32_t point, const DVec3& center) const {
    constexpr std::size_t kNeighbours = 12, kWide = 48, kFewest = 5, kFewestMoved = 4;
    constexpr float kSameSide = 0.5f;
    constexpr double kSameShape = 1e-3, kSameSize = 0.01;  // a brush that bends a surface hardly scales it
    constexpr double kBent = 0.3;
    std::array<std::uint32_t, kWide> near;
    std::array<double, kWide> squared;
    const std::size_t count = tree_.nearest(file_.positions[point], near, squared);
    std::vector<DVec3> before, now, movedBefore, movedNow;
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t other = near[k];
      if (points_[other].gone) continue;
      const bool isSameSide = glm::dot(file_.normals[other], file_.normals[point]) > kSameSide;
      if (k < kNeighbours && isSameSide) before.push_back(inFile(other)), now.push_back(present(other));
      if (hasMoved(other) && movedBefore.size() < kNeighbours)
        movedBefore.push_back(inFile(other)), movedNow.push_back(present(other));
    }
    if (movedBefore.size() >= kFewestMoved) {
      const Similarity fit = nearestSimilarity(movedBefore, movedNow);
      const double scale = std::abs(fit.scale - 1) > kSameSize ? fit.scale : 1;
      if (fit.misfit < kSameShape) return {fit.rotation, inFile(point), present(point), scale};
    }
    if (before.size() >= kFewest)
      if (const Similarity fit = nearestSimilarity(before, now); fit.misfit < kBent)
        return {fit.rotation, center, center + (present(point) - inFile(point))};
    return alongWith(center, point, points_[point]);
  }

  /// From a point of the file to a state, with the normal.
  GaussianMotion alongWith(const DVec3& center, std::uint32_t point, const PointState& to) const {
    const DQuat rotation =
        shortestRotation(glm::normalize(DVec3(file_.normals[point])), glm::normalize(DVec3(to.normal)));
    return {rotation, center, center + (DVec3(to.position) - DVec3(file_.positions[point]))};
  }

  void appendNew(BareVector<std::byte>& rows) const {
    std::unordered_map<std::uint32_t, std::vector<std::size_t>> copied;  // by ancestor
    for (std::size_t i = file_.size(); i < points_.size(); ++i)
      if (!points_[i].gone) copied[static_cast<std::uint32_t>(ancestorOf(points_, i, file_.size()))];
    if (copied.empty()) return;
    for (std::size_t i = 0; i < owners_.size(); ++i)
      if (const auto found = copied.find(owners_[i].point); found != copied.end() && owners_[i].isNear)
        found->second.push_back(i);
    addNearest(copied);
    for (std::size_t i = file_.size(); i < points_.size(); ++i) {
      if (points_[i].gone) continue;
      const auto ancestor = static_cast<std::uint32_t>(ancestorOf(points_, i, file_.size()));
      for (const std::size_t gaussian : copied.at(ancestor)) {
        rows.insert(rows.end(), records_.row(gaussian), records_.row(gaussian) + records_.rowBytes);
        std::byte* const row = rows.data() + rows.size() - records_.rowBytes;
        columns_.move(row, alongWith(columns_.center(row), ancestor, points_[i]));
        const Vec3 logs = columns_.logScales(row);
        const double excess = static_cast<double>(std::max({logs.x, logs.y, logs.z})) - std::log(spacing_);
        if (excess > 0) columns_.scale(row, -excess);
        if (points_[i].color != packedColor(file_, ancestor)) columns_.paint(row, unpackedColor(points_[i].color));
      }
    }
  }

  /// Gives the ancestors without Gaussians of their own the nearest one of another point.
  void addNearest(std::unordered_map<std::uint32_t, std::vector<std::size_t>>& copied) const {
    const auto hasNone = [](const auto& each) { return each.second.empty(); };
    if (std::ranges::none_of(copied, hasNone)) return;
    const auto near = parallelCollect(
        owners_.size(), threads_, [&](std::size_t i) { return owners_[i].isNear; }, [](std::size_t i) { return i; });
    if (near.empty()) return;
    std::vector<Vec3> centers;
    for (const std::size_t i : near) centers.push_back(relativeCenter(i));
    const PointTree tree(centers, threads_);
    for (auto& [ancestor, gaussians] : copied) {
      if (!gaussians.empty()) continue;
      std::uint32_t found = 0;
      double squared = 0;
      tree.nearest(file_.positions[ancestor], {&found, 1}, {&squared, 1});
      gaussians.push_back(near[found]);
    }
  }

  const PointCloud& file_;
  const GaussianRecords& records_;
  const GaussianColumns columns_;
  const std::span<const PointState> points_;
  const unsigned threads_;
  const double spacing_;
  const bool isAnyGone_;  // of the file's points
  const PointTree tree_;
  const BareVector<Owner> owners_;
};

}  // namespace

BareVector<GaussianOwner> gaussianOwners(const PointCloud& file, unsigned threads) {
  const GaussianRecords& records = *gaussiansOf(file);
  const GaussianColumns columns(records);
  const double spacing = meanSpacing(file, threads);
  const PointTree tree(file.positions, threads);
  return parallelMake(records.size(), threads, [&](std::size_t i) {
    GaussianOwner owner = ownerIn(tree, Vec3(columns.center(records.row(i)) - file.origin), spacing);
    if (owner.isNear) addBeside(file, tree, owner);
    return owner;
  });
}

std::shared_ptr<const FormatBaggage> editedGaussians(const PointCloud& file, std::span<const PointState> points,
                                                     unsigned threads) {
  const GaussianRecords* const records = gaussiansOf(file);
  if (!records || file.empty() || changedPoints(file, points) == 0) return file.storedAs.baggage;
  return GaussianEdit(file, *records, points, threads).result();
}

std::shared_ptr<const GaussianRecords> withPointBytes(const PointCloud& cloud, std::string_view name,
                                                      std::span<const std::byte> ofPoints, unsigned threads) {
  const GaussianRecords& records = *gaussiansOf(cloud);
  std::vector<GaussianRecords::Column> columns = records.columns;
  const GaussianRecords::Column* const had = records.find(name);
  if (!had) columns.push_back({std::string(name), ScalarType::u8, records.rowBytes});
  const std::size_t offset = had ? had->offset : records.rowBytes, bytes = records.rowBytes + (had ? 0 : 1);
  PALPATE_CHECK(!had || had->type == ScalarType::u8);
  const BareVector<GaussianOwner> owners = gaussianOwners(cloud, threads);
  BareVector<std::byte> rows(records.size() * bytes);
  parallelFor(records.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::byte* const row = rows.data() + i * bytes;
      if (!had) row[offset] = std::byte{0};
      std::memcpy(row, records.row(i), records.rowBytes);
      if (owners[i].isNear) row[offset] = ofPoints[owners[i].point];
    }
  });
  return std::make_shared<const GaussianRecords>(std::move(columns), std::move(rows));
}

void addPointBytes(PointCloud& cloud, std::string_view name, unsigned threads) {
  const GaussianRecords& records = *gaussiansOf(cloud);
  const GaussianRecords::Column* const column = records.find(name);
  if (!column || column->type != ScalarType::u8 || cloud.empty()) return;
  const BareVector<GaussianOwner> owners = gaussianOwners(cloud, threads);
  Attribute values{std::string(name), ScalarType::u8, {}};
  values.data.resize(cloud.size());
  std::vector<std::uint8_t> isOwner(cloud.size());
  std::vector<Vec3> centers;
  std::vector<std::byte> ofCenters;
  const GaussianColumns columns(records);
  for (std::size_t i = 0; i < records.size(); ++i) {
    const auto& [point, distance, isNear, beside, across] = owners[i];
    if (!isNear) continue;
    const std::byte value = records.row(i)[column->offset];
    values.data[point] = std::max(values.data[point], value);
    isOwner[point] = 1;
    centers.emplace_back(columns.center(records.row(i)) - cloud.origin);
    ofCenters.push_back(value);
  }
  if (centers.empty()) return;
  const PointTree tree(centers, threads);
  parallelFor(cloud.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::uint32_t nearest = 0;
      double squared = 0;
      if (isOwner[i] || tree.nearest(cloud.positions[i], {&nearest, 1}, {&squared, 1}) == 0) continue;
      values.data[i] = ofCenters[nearest];
    }
  });
  cloud.extra.push_back(std::move(values));
}

std::shared_ptr<const GaussianRecords> movedGaussians(const GaussianRecords& records, const DQuat& rotation,
                                                      const DVec3& from, const DVec3& to, unsigned threads) {
  const GaussianColumns columns(records);
  const GaussianMotion motion(rotation, from, to);
  BareVector<std::byte> rows = records.rows;
  parallelFor(records.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) columns.move(rows.data() + i * records.rowBytes, motion);
  });
  return std::make_shared<const GaussianRecords>(records.columns, std::move(rows));
}

}  // namespace palpate
