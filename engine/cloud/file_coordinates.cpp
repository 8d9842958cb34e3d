#include "engine/cloud/file_coordinates.hpp"

#include <glm/common.hpp>

#include "engine/core/parallel_collect.hpp"

namespace palpate {

Bounds fileBoundsOf(const PointCloud& cloud) {
  if (cloud.empty() || !isExact(cloud)) {
    const Bounds box = boundsOf(cloud);
    return {box.min + cloud.origin, box.max + cloud.origin};
  }
  const DVec3 first = cloud.fileCoordinates(0);
  return parallelReduce(
      cloud.size(), 0, Bounds{first, first},
      [&](std::size_t begin, std::size_t end) {
        Bounds box{cloud.fileCoordinates(begin), cloud.fileCoordinates(begin)};
        for (std::size_t i = begin; i < end; ++i) {
          const DVec3 place = cloud.fileCoordinates(i);
          box = {glm::min(box.min, place), glm::max(box.max, place)};
        }
        return box;
      },
      [](const Bounds& a, const Bounds& b) {
        return Bounds{glm::min(a.min, b.min), glm::max(a.max, b.max)};
      });
}

}  // namespace palpate
