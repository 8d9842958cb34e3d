#include "engine/cloud/estimated_normals.hpp"

#include <algorithm>
#include <string_view>

namespace palpate {

namespace {

constexpr std::string_view kEstimated = "comment normals: estimated";

}  // namespace

void markNormalsAsEstimated(PointCloud& cloud, bool are) {
  std::erase(cloud.storedAs.comments, kEstimated);
  if (are) cloud.storedAs.comments.emplace_back(kEstimated);
}

bool areNormalsEstimated(const PointCloud& cloud) {
  return std::ranges::find(cloud.storedAs.comments, kEstimated) != cloud.storedAs.comments.end();
}

}  // namespace palpate
