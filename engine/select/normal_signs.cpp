#include "engine/select/normal_signs.hpp"

#include <numeric>

#include "engine/cloud/normals.hpp"

namespace palpate {

void orientNormals(PointCloud& cloud, unsigned threads, std::optional<UpAxis> up) {
  constexpr unsigned kNeighbours = 16;
  if (!cloud.hasNormals()) return;
  const Places places = distinctPlaces(cloud.positions, threads);
  const std::size_t count = places.positions.size();
  NeighbourGraph graph{.degree = kNeighbours, .neighbours = {}};
  graph.neighbours.resize(graph.degree * count);
  std::vector<std::uint32_t> all(count);
  std::iota(all.begin(), all.end(), 0u);
  std::vector<FittedPlane> planes(count);
  fitNearestPlanes(places.positions, all, kNeighbours, planes, graph, threads);
  std::vector<Vec3> normals(count);
  for (std::size_t i = 0; i < cloud.size(); ++i) normals[places.placeOf[i]] = cloud.normals[i];
  orientNormals(places.positions, normals, graph, threads, up ? *up : findUp(cloud).up);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (glm::dot(cloud.normals[i], normals[places.placeOf[i]]) < 0) cloud.normals[i] = -cloud.normals[i];
}

void flipNormals(PointCloud& cloud) {
  for (Vec3& normal : cloud.normals) normal = -normal;
}

}  // namespace palpate
