#include "engine/cloud/point_tree.hpp"

#include <nanoflann.hpp>

#include "engine/core/check.hpp"
#include "engine/core/stop_checks.hpp"

namespace palpate {
namespace {

constexpr std::size_t kLeafSize = 24;

// Collects the points of a ball that the tree visits.
class Ball {
 public:
  Ball(double radius, std::vector<std::uint32_t>& found) : squared_(radius * radius), found_(found) {}
  bool addPoint(double squaredDistance, std::uint32_t index) {
    if (squaredDistance < squared_) found_.push_back(index);
    return true;
  }
  // For the tree's pruning, whose sums are rounded; the test above is exact.
  double worstDist() const { return squared_ * (1 + 1e-9); }
  bool full() const { return true; }

 private:
  double squared_;
  std::vector<std::uint32_t>& found_;
};

}  // namespace

struct PointTree::Index {
  struct PointsView {
    std::span<const Vec3> points;
    bool isBuilding = true;  // built by one thread; queried by many
    mutable StopChecks checks = {};
    std::size_t kdtree_get_point_count() const { return points.size(); }
    double kdtree_get_pt(std::size_t i, std::size_t axis) const {
      if (isBuilding) checks();
      return static_cast<double>((&points[i].x)[axis]);
    }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };

  // Everything in double: squares of float32 would underflow for small models, and the centre of a ball is not a point
  // of the cloud.
  using Metric = nanoflann::L2_Simple_Adaptor<double, PointsView, double, std::uint32_t>;
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<Metric, PointsView, 3, std::uint32_t>;

  explicit Index(std::span<const Vec3> points) : view{points}, tree(3, view, {kLeafSize}) { view.isBuilding = false; }
  PointsView view;
  Tree tree;
};

PointTree::PointTree(std::span<const Vec3> points) { PointTree::build(points); }

PointTree::~PointTree() = default;

void PointTree::build(std::span<const Vec3> positions) {
  PALPATE_CHECK_LT(positions.size(), std::size_t{1} << 32);
  index_.reset();  // first, so that only one exists at a time
  index_ = std::make_unique<Index>(positions);
}

void PointTree::move(std::span<const PointMove> moves) {
  if (!moves.empty()) build(index_->view.points);
}

std::size_t PointTree::nearest(const Vec3& p, std::span<std::uint32_t> indices,
                               std::span<double> squaredDistances) const {
  PALPATE_CHECK_EQ(indices.size(), squaredDistances.size());
  if (index_->view.points.empty() || indices.empty()) return 0;
  const DVec3 place(p);
  return index_->tree.knnSearch(&place.x, indices.size(), indices.data(), squaredDistances.data());
}

void PointTree::near(const DVec3& center, double radius, std::vector<std::uint32_t>& found) const {
  Ball ball(radius, found);
  index_->tree.findNeighbors(ball, &center.x, {});
}

std::span<const std::uint32_t> PointTree::order() const {
  if (index_->view.points.empty()) return {};
  return index_->tree.vAcc;
}

std::size_t PointTree::bytes() const { return index_->tree.usedMemory(index_->tree); }

}  // namespace palpate
