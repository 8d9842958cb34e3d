#include "engine/select/thin_plate.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "engine/core/check.hpp"

namespace palpate {

namespace {

// r^2 log r, of the square.
double kernel(double squared) { return squared > 0 ? 0.5 * squared * std::log(squared) : 0; }

// Gaussian elimination with partial pivoting; `rows` has one more column with the right-hand side, and leaves the
// solution there.
void solve(std::vector<std::vector<double>>& rows) {
  const std::size_t count = rows.size();
  for (std::size_t k = 0; k < count; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < count; ++i)
      if (std::abs(rows[i][k]) > std::abs(rows[pivot][k])) pivot = i;
    std::swap(rows[k], rows[pivot]);
    PALPATE_CHECK(rows[k][k] != 0);
    for (std::size_t i = k + 1; i < count; ++i) {
      const double factor = rows[i][k] / rows[k][k];
      if (factor == 0) continue;
      for (std::size_t j = k; j <= count; ++j) rows[i][j] -= factor * rows[k][j];
    }
  }
  for (std::size_t k = count; k-- > 0;) {
    for (std::size_t j = k + 1; j < count; ++j) rows[k][count] -= rows[k][j] * rows[j][count];
    rows[k][count] /= rows[k][k];
  }
}

}  // namespace

ThinPlate::ThinPlate(std::span<const DVec2> at, std::span<const double> heights, double smoothing)
    : at_(at.begin(), at.end()) {
  PALPATE_CHECK_EQ(at.size(), heights.size());
  const std::size_t count = at.size();
  std::vector<std::vector<double>> rows(count + plane_.size(), std::vector<double>(count + plane_.size() + 1));
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const DVec2 offset = at[i] - at[j];
      rows[i][j] = rows[j][i] = kernel(glm::dot(offset, offset));
    }
    rows[i][i] = 8 * std::numbers::pi * smoothing;
    const std::array<double, 3> plane{1, at[i].x, at[i].y};
    for (std::size_t k = 0; k < plane.size(); ++k) rows[i][count + k] = rows[count + k][i] = plane[k];
    rows[i].back() = heights[i];
  }
  constexpr double kTiny = 1e-9;  // so that positions on a line have a solution, too
  for (std::size_t k = count; k < rows.size(); ++k) rows[k][k] = -kTiny;
  solve(rows);
  for (std::size_t i = 0; i < count; ++i) weights_.push_back(rows[i].back());
  for (std::size_t k = 0; k < plane_.size(); ++k) plane_[k] = rows[count + k].back();
}

double ThinPlate::height(const DVec2& at) const {
  double height = plane_[0] + plane_[1] * at.x + plane_[2] * at.y;
  for (std::size_t i = 0; i < at_.size(); ++i) {
    const DVec2 offset = at - at_[i];
    height += weights_[i] * kernel(glm::dot(offset, offset));
  }
  return height;
}

DVec2 ThinPlate::slope(const DVec2& at) const {
  DVec2 slope(plane_[1], plane_[2]);
  for (std::size_t i = 0; i < at_.size(); ++i) {
    const DVec2 offset = at - at_[i];
    const double squared = glm::dot(offset, offset);
    if (squared > 0) slope += weights_[i] * (std::log(squared) + 1) * offset;
  }
  return slope;
}

}  // namespace palpate
