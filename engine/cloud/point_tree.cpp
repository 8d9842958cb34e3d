#include "engine/cloud/point_tree.hpp"

#include <nanoflann.hpp>

#include "engine/core/check.hpp"

namespace palpate {
namespace {

struct PointsView {
  std::span<const Vec3> points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const { return (&points[i].x)[axis]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

// Coordinates as they are, distances in double: squares of float32 would underflow for small models.
using Metric = nanoflann::L2_Simple_Adaptor<float, PointsView, double, std::uint32_t>;
using Tree = nanoflann::KDTreeSingleIndexAdaptor<Metric, PointsView, 3, std::uint32_t>;
constexpr std::size_t kLeafSize = 24;

}  // namespace

struct PointTree::Index {
  explicit Index(std::span<const Vec3> points) : view{points}, tree(3, view, {kLeafSize}) {}
  PointsView view;
  Tree tree;
};

PointTree::PointTree(std::span<const Vec3> points) {
  PALPATE_CHECK_LT(points.size(), std::size_t{1} << 32);
  index_ = std::make_unique<Index>(points);
}

PointTree::~PointTree() = default;

std::size_t PointTree::nearest(const Vec3& p, std::span<std::uint32_t> indices,
                               std::span<double> squaredDistances) const {
  PALPATE_CHECK_EQ(indices.size(), squaredDistances.size());
  if (index_->view.points.empty() || indices.empty()) return 0;
  return index_->tree.knnSearch(&p.x, indices.size(), indices.data(), squaredDistances.data());
}

}  // namespace palpate
