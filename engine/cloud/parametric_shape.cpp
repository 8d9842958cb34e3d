#include "engine/cloud/parametric_shape.hpp"

#include "engine/core/parallel.hpp"

namespace palpate {
namespace {

/// Solves the integral from 0 to t of (from + (to - from) x) dx = part, 0 <= t <= 1, in the form that does not cancel.
double invertLinear(double from, double to, double part) {
  const double root = std::sqrt(std::max(0.0, from * from + 2 * (to - from) * part));
  const double sum = from + root;
  return sum > 0 ? std::clamp(2 * part / sum, 0.0, 1.0) : 0.0;
}

}  // namespace

AreaTable::AreaTable(std::size_t rows, std::size_t columns, const std::function<double(const DVec2&)>& density,
                     unsigned threads)
    : rows_(rows),
      columns_(columns),
      density_((rows + 1) * (columns + 1)),
      cumulative_(density_.size()),
      marginal_(rows + 1) {
  const std::size_t width = columns + 1;
  parallelFor(density_.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      density_[k] = density({static_cast<double>(k / width) / static_cast<double>(rows),
                             static_cast<double>(k % width) / static_cast<double>(columns)});
  });
  for (std::size_t row = 0; row <= rows; ++row)
    for (std::size_t k = row * width + 1; k < (row + 1) * width; ++k)
      cumulative_[k] = cumulative_[k - 1] + 0.5 * (density_[k - 1] + density_[k]);
  for (std::size_t row = 1; row <= rows; ++row)
    marginal_[row] = marginal_[row - 1] + 0.5 * (cumulative(row - 1, columns) + cumulative(row, columns));
}

DVec2 AreaTable::operator()(const DVec2& uniform) const {
  const double rowShare = uniform.x * marginal_.back();
  const auto above = std::upper_bound(marginal_.begin() + 1, marginal_.end() - 1, rowShare);
  const auto row = static_cast<std::size_t>(above - marginal_.begin()) - 1;
  const double t = invertLinear(cumulative(row, columns_), cumulative(row + 1, columns_), rowShare - marginal_[row]);

  const auto mixed = [&](double a, double b) { return a + t * (b - a); };
  const auto mixedCumulative = [&](std::size_t column) {
    return mixed(cumulative(row, column), cumulative(row + 1, column));
  };
  const double columnShare = uniform.y * mixedCumulative(columns_);
  std::size_t low = 0, high = columns_;
  while (high - low > 1) {
    const std::size_t middle = (low + high) / 2;
    (mixedCumulative(middle) <= columnShare ? low : high) = middle;
  }
  const double from = mixed(node(row, low), node(row + 1, low));
  const double to = mixed(node(row, low + 1), node(row + 1, low + 1));
  const double s = invertLinear(from, to, columnShare - mixedCumulative(low));
  return {(static_cast<double>(row) + t) / static_cast<double>(rows_),
          (static_cast<double>(low) + s) / static_cast<double>(columns_)};
}

}  // namespace palpate
