#include "engine/cloud/even_points.hpp"

#include <array>
#include <compare>

#include "engine/cloud/morton.hpp"
#include "engine/cloud/morton_cells.hpp"
#include "engine/core/check.hpp"
#include "engine/core/parallel.hpp"
#include "engine/core/parallel_sort.hpp"

namespace palpate {

namespace {

constexpr std::size_t kPasses = 8;  // as many as the parities of three coordinates

constexpr float kSide = 2;         // distances along a cell: looking cells up costs more than looking at points
constexpr float kSameFace = 0.5f;  // cosine of the normals of points that keep company

/// Points by the cells of a grid.
class GriddedPoints {
 public:
  GriddedPoints(std::span<const Vec3> points, std::span<const Vec3> normals, float distance, unsigned threads)
      : points_(points),
        normals_(normals),
        distance_(distance),
        side_(kSide * distance),
        order_(points.size()),
        kept_(points.size(), 0) {
    parallelFor(points.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        order_[i] = {mortonCode(mortonCell(points_[i], side_)), static_cast<std::uint32_t>(i)};
    });
    parallelSort(order_, threads);
    std::vector<std::uint64_t> codes;
    for (std::size_t k = 0; k < order_.size(); ++k) {
      if (!codes.empty() && codes.back() == order_[k].code) continue;
      codes.push_back(order_[k].code);
      begins_.push_back(k);
    }
    begins_.push_back(order_.size());
    cells_ = MortonCells(std::move(codes));
  }

  std::vector<std::uint32_t> evenlySpaced(unsigned threads) {
    std::array<std::vector<std::uint32_t>, kPasses> passes;
    for (std::uint32_t cell = 0; cell < cells_.count(); ++cell) passes[cells_.code(cell) % kPasses].push_back(cell);
    for (const std::vector<std::uint32_t>& pass : passes)
      parallelFor(pass.size(), threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) chooseIn(pass[k]);
      });
    return chosen();
  }

  std::vector<std::uint32_t> inCompany(std::size_t fewest, unsigned threads) {
    forEachPoint(threads,
                 [&](std::uint32_t point, const Around& around) { kept_[point] = hasCompany(point, around, fewest); });
    return chosen();
  }

  std::vector<Vec3> smoothedNormals(unsigned threads) const {
    std::vector<Vec3> smooth(points_.size());
    forEachPoint(threads, [&](std::uint32_t point, const Around& around) {
      Vec3 sum(0);
      forNear(point, around, [&](std::uint32_t other) {
        if (glm::dot(normals_[point], normals_[other]) > kSameFace) sum += normals_[other];
        return false;
      });
      smooth[point] = glm::normalize(sum);  // its own is among them, and all are on its side
    });
    return smooth;
  }

 private:
  struct Entry {
    std::uint64_t code = 0;
    std::uint32_t point = 0;
    auto operator<=>(const Entry&) const = default;
  };

  struct Around {
    std::array<std::uint32_t, 27> cells;
    std::size_t count = 0;
  };
  Around cellsAround(std::size_t cell) const {
    const IVec3 at = mortonCell(points_[order_[begins_[cell]].point], side_);
    Around around;
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x)
          if (const auto near = cells_.find(mortonCode(at + IVec3(x, y, z)))) around.cells[around.count++] = *near;
    return around;
  }

  template <class Use>
  void forEachPoint(unsigned threads, Use&& use) const {
    parallelFor(cells_.count(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t cell = begin; cell < end; ++cell) {
        const Around around = cellsAround(cell);
        for (std::size_t k = begins_[cell]; k < begins_[cell + 1]; ++k) use(order_[k].point, around);
      }
    });
  }

  /// Calls use(other) for the points nearer than the distance, itself included, until it says that it has enough.
  template <class Use>
  void forNear(std::uint32_t point, const Around& around, Use&& use) const {
    for (std::size_t c = 0; c < around.count; ++c)
      for (std::size_t k = begins_[around.cells[c]]; k < begins_[around.cells[c] + 1]; ++k) {
        const Vec3 way = points_[order_[k].point] - points_[point];
        if (glm::dot(way, way) < distance_ * distance_ && use(order_[k].point)) return;
      }
  }

  void chooseIn(std::uint32_t cell) {
    const Around around = cellsAround(cell);
    for (std::size_t k = begins_[cell]; k < begins_[cell + 1]; ++k) {
      const std::uint32_t point = order_[k].point;
      bool free = true;
      forNear(point, around, [&](std::uint32_t other) {
        if (kept_[other] && glm::dot(normals_[point], normals_[other]) >= 0) free = false;
        return !free;
      });
      kept_[point] = free;
    }
  }

  bool hasCompany(std::uint32_t point, const Around& around, std::size_t fewest) const {
    std::size_t found = 0;
    forNear(point, around, [&](std::uint32_t other) {
      if (other != point && glm::dot(normals_[point], normals_[other]) > kSameFace) ++found;
      return found >= fewest;
    });
    return found >= fewest;
  }

  std::vector<std::uint32_t> chosen() const {
    std::vector<std::uint32_t> numbers;
    for (std::uint32_t i = 0; i < kept_.size(); ++i)
      if (kept_[i]) numbers.push_back(i);
    return numbers;
  }

  std::span<const Vec3> points_, normals_;
  float distance_, side_;            // of a cell
  std::vector<Entry> order_;         // by cell
  std::vector<std::size_t> begins_;  // of the cells, and the end of the last
  MortonCells cells_;
  std::vector<std::uint8_t> kept_;
};

}  // namespace

std::vector<std::uint32_t> evenlySpaced(std::span<const Vec3> points, std::span<const Vec3> normals, float distance,
                                        unsigned threads) {
  PALPATE_CHECK_EQ(points.size(), normals.size());
  PALPATE_CHECK_LT(0.0f, distance);
  return GriddedPoints(points, normals, distance, threads).evenlySpaced(threads);
}

std::vector<std::uint32_t> inCompany(std::span<const Vec3> points, std::span<const Vec3> normals, float distance,
                                     std::size_t fewest, unsigned threads) {
  PALPATE_CHECK_EQ(points.size(), normals.size());
  PALPATE_CHECK_LT(0.0f, distance);
  return GriddedPoints(points, normals, distance, threads).inCompany(fewest, threads);
}

std::vector<Vec3> smoothedNormals(std::span<const Vec3> points, std::span<const Vec3> normals, float distance,
                                  unsigned threads) {
  PALPATE_CHECK_EQ(points.size(), normals.size());
  PALPATE_CHECK_LT(0.0f, distance);
  return GriddedPoints(points, normals, distance, threads).smoothedNormals(threads);
}

}  // namespace palpate
