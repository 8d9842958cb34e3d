// A shape from a formula with derivatives: closest points by Newton's method, even sampling by a table of its area
// density.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include <glm/common.hpp>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/point_tree.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

/// Numbers that carry their first and second derivatives by two parameters u and v (forward automatic differentiation;
/// Griewank and Walther 2008, chapter 13), so that a surface is written once, as its formula, and its normals and
/// curvatures are exact.
struct Jet {
  double value = 0, u = 0, v = 0, uu = 0, uv = 0, vv = 0;

  constexpr Jet() = default;
  constexpr Jet(double constant) : value(constant) {}  // NOLINT: constants mix freely with jets
  constexpr Jet(double f, double fu, double fv, double fuu, double fuv, double fvv)
      : value(f), u(fu), v(fv), uu(fuu), uv(fuv), vv(fvv) {}
  static constexpr Jet parameterU(double u) { return {u, 1, 0, 0, 0, 0}; }
  static constexpr Jet parameterV(double v) { return {v, 0, 1, 0, 0, 0}; }
};

constexpr Jet operator+(const Jet& a, const Jet& b) {
  return {a.value + b.value, a.u + b.u, a.v + b.v, a.uu + b.uu, a.uv + b.uv, a.vv + b.vv};
}
constexpr Jet operator-(const Jet& a, const Jet& b) {
  return {a.value - b.value, a.u - b.u, a.v - b.v, a.uu - b.uu, a.uv - b.uv, a.vv - b.vv};
}
constexpr Jet operator*(const Jet& a, const Jet& b) {
  return {a.value * b.value,
          a.u * b.value + a.value * b.u,
          a.v * b.value + a.value * b.v,
          a.uu * b.value + 2 * a.u * b.u + a.value * b.uu,
          a.uv * b.value + a.u * b.v + a.v * b.u + a.value * b.uv,
          a.vv * b.value + 2 * a.v * b.v + a.value * b.vv};
}

/// f(a), from the values of f, f' and f'' at a.value.
constexpr Jet chain(const Jet& a, double f, double f1, double f2) {
  return {f, f1 * a.u, f1 * a.v, f1 * a.uu + f2 * a.u * a.u, f1 * a.uv + f2 * a.u * a.v, f1 * a.vv + f2 * a.v * a.v};
}
inline Jet sin(const Jet& a) { return chain(a, std::sin(a.value), std::cos(a.value), -std::sin(a.value)); }
inline Jet cos(const Jet& a) { return chain(a, std::cos(a.value), -std::sin(a.value), -std::cos(a.value)); }
inline Jet exp(const Jet& a) { return chain(a, std::exp(a.value), std::exp(a.value), std::exp(a.value)); }
/// 1 / sqrt(a), a > 0.
inline Jet inverseSqrt(const Jet& a) {
  const double f = 1 / std::sqrt(a.value);
  return chain(a, f, -0.5 * f / a.value, 0.75 * f / (a.value * a.value));
}

struct JetVec3 {
  Jet x, y, z;

  DVec3 value() const { return {x.value, y.value, z.value}; }
  DVec3 u() const { return {x.u, y.u, z.u}; }
  DVec3 v() const { return {x.v, y.v, z.v}; }
  DVec3 uu() const { return {x.uu, y.uu, z.uu}; }
  DVec3 uv() const { return {x.uv, y.uv, z.uv}; }
  DVec3 vv() const { return {x.vv, y.vv, z.vv}; }
};
constexpr JetVec3 operator+(const JetVec3& a, const JetVec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr JetVec3 operator-(const JetVec3& a, const JetVec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr JetVec3 operator*(const Jet& s, const JetVec3& a) { return {s * a.x, s * a.y, s * a.z}; }
constexpr Jet dot(const JetVec3& a, const JetVec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr JetVec3 cross(const JetVec3& a, const JetVec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline JetVec3 normalize(const JetVec3& a) { return inverseSqrt(dot(a, a)) * a; }

/// Converts a density over the unit square into a map that distributes points by it: first the row by the marginal
/// distribution, then the position in the row by the conditional one (Devroye 1986, section XI.2). The density is
/// bilinear between grid nodes and inverted exactly, so the map has no seams at the cells.
class AreaTable {
 public:
  /// `density` must be positive. It is evaluated at (rows + 1) x (columns + 1) nodes, from several threads.
  AreaTable(std::size_t rows, std::size_t columns, const std::function<double(const DVec2&)>& density,
            unsigned threads);

  /// (0..1, 0..1), uniform, to (row 0..1, column 0..1), distributed by the density. Monotone in each coordinate.
  DVec2 operator()(const DVec2& uniform) const;

 private:
  double node(std::size_t row, std::size_t column) const { return density_[row * (columns_ + 1) + column]; }
  double cumulative(std::size_t row, std::size_t column) const { return cumulative_[row * (columns_ + 1) + column]; }

  std::size_t rows_, columns_;
  std::vector<double> density_;     // at the nodes
  std::vector<double> cumulative_;  // integral of the row from its start to the node, in cells
  std::vector<double> marginal_;    // integral of the rows' totals up to each row, in cells
};

/// Grid over the unit square on which a form is sampled.
struct GridSize {
  std::size_t rows, columns;
};

/// A `Form` is a closed surface in its own units with these members:
/// - Site: a position on it, a vector of GLM
/// - Site site(DVec2): the site for a point of the unit square, which covers the form
/// - JetVec3 at(Site): the point there, with derivatives in a chart (u, v) around the site; u x v points outward
/// - Site moved(Site, DVec2): the site at (u, v) of that chart
/// - double areaDensity(DVec2): area per area of the unit square
/// - kSeeds, kTable: GridSize of the starts for Newton (finer than a quarter of the smallest detail), and of the area
/// table
template <class Form>
class ParametricShape final : public AnalyticShape {
 public:
  using Site = typename Form::Site;

  ParametricShape(double size, const DVec3& center) : AnalyticShape(size, center) {
    const GridSize grid = Form::kSeeds;
    for (std::size_t k = 0; k < grid.rows * grid.columns; ++k) {
      const DVec2 square((static_cast<double>(k / grid.columns) + 0.5) / static_cast<double>(grid.rows),
                         (static_cast<double>(k % grid.columns) + 0.5) / static_cast<double>(grid.columns));
      seeds_.push_back(form_.site(square));
      seedPositions_.push_back(Vec3(form_.at(seeds_.back()).value()));
    }
    Bounds box;
    for (int axis = 0; axis < 3; ++axis) {
      box.min[axis] = extreme(axis, -1);
      box.max[axis] = extreme(axis, 1);
    }
    middle_ = box.center();
    scale_ = size / box.longestSide();
    tree_ = std::make_unique<PointTree>(seedPositions_);
  }

  /// The best result of Newton's method from the nearest seeds.
  SurfacePoint closest(const DVec3& p) const override {
    constexpr std::size_t kStarts = 8;
    const DVec3 local = (p - center()) / scale_ + middle_;
    std::array<std::uint32_t, kStarts> nearest{};
    std::array<double, kStarts> squaredDistances{};
    const std::size_t starts = tree_->nearest(Vec3(local), nearest, squaredDistances);
    Site best = seeds_[nearest[0]];
    double bestSquared = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < starts; ++k) {
      const auto [site, squared] = descend(seeds_[nearest[k]], local);
      if (squared < bestSquared) best = site, bestSquared = squared;
    }
    return place(form_.at(best));
  }

  AreaMap areaMap(unsigned threads) const override {
    // Takes longer than a small sampling, and is the same for all samplings.
    std::call_once(tableMade_, [&] {
      const auto density = [this](const DVec2& square) { return form_.areaDensity(square); };
      table_ = std::make_unique<const AreaTable>(Form::kTable.rows, Form::kTable.columns, density, threads);
    });
    return [this](const DVec2& uniform) { return place(form_.at(form_.site((*table_)(uniform)))); };
  }

 private:
  SurfacePoint place(const JetVec3& surface) const {
    return {(surface.value() - middle_) * scale_ + center(), glm::normalize(glm::cross(surface.u(), surface.v()))};
  }

  /// The minimum (side -1) or maximum (side 1) coordinate of the form: that of the point closest to a far position,
  /// from the best seed.
  double extreme(int axis, double side) const {
    constexpr double kFar = 100;  // form units
    const auto further = [&](const Vec3& a, const Vec3& b) { return side * a[axis] < side * b[axis]; };
    const auto best = std::max_element(seedPositions_.begin(), seedPositions_.end(), further);
    DVec3 farOut(*best);
    farOut[axis] += side * kFar;
    return form_.at(descend(seeds_[static_cast<std::size_t>(best - seedPositions_.begin())], farOut).site)
        .value()[axis];
  }

  struct Descent {
    Site site;
    double squaredDistance;
  };
  /// Newton's method on half the squared distance to `p`, halving a step that does not decrease it. Where the Hessian
  /// is not positive definite (p is beyond a centre of curvature) the metric alone replaces it, which still descends.
  Descent descend(Site site, const DVec3& p) const {
    constexpr int kMaxSteps = 60;
    JetVec3 surface = form_.at(site);
    double squared = glm::dot(surface.value() - p, surface.value() - p);
    for (int step = 0; step < kMaxSteps; ++step) {
      DVec2 change = newtonStep(surface, p);
      bool lower = false;
      for (int halving = 0; halving < 12 && !lower; ++halving, change *= 0.5) {
        const Site next = form_.moved(site, change);
        const JetVec3 there = form_.at(next);
        const double squaredThere = glm::dot(there.value() - p, there.value() - p);
        lower = squaredThere < squared;
        if (lower) site = next, surface = there, squared = squaredThere;
      }
      if (!lower) break;  // converged to double precision
    }
    // The squared distance is flat to rounding near its minimum; one more step makes the position itself exact.
    const DVec2 last = newtonStep(surface, p);
    if (glm::dot(last, last) < 1e-10) site = form_.moved(site, last);
    return {site, squared};
  }

  static DVec2 newtonStep(const JetVec3& surface, const DVec3& p) {
    const DVec3 offset = surface.value() - p, u = surface.u(), v = surface.v();
    const DVec2 gradient(glm::dot(offset, u), glm::dot(offset, v));
    const DVec3 metric(glm::dot(u, u), glm::dot(u, v), glm::dot(v, v));
    const DVec3 bend(glm::dot(offset, surface.uu()), glm::dot(offset, surface.uv()), glm::dot(offset, surface.vv()));
    DVec3 h = metric + bend;
    if (h.x <= 0 || h.x * h.z - h.y * h.y <= 1e-3 * (metric.x * metric.z - metric.y * metric.y)) h = metric;
    const double determinant = h.x * h.z - h.y * h.y;
    return -DVec2(h.z * gradient.x - h.y * gradient.y, h.x * gradient.y - h.y * gradient.x) / determinant;
  }

  Form form_;
  std::vector<Site> seeds_;
  std::vector<Vec3> seedPositions_;  // in the form's units
  std::unique_ptr<PointTree> tree_;
  DVec3 middle_{0};   // of the form's box, in its units
  double scale_ = 1;  // model units per unit of the form
  mutable std::once_flag tableMade_;
  mutable std::unique_ptr<const AreaTable> table_;
};

}  // namespace palpate
