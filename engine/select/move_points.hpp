// Points at other coordinates, and clouds that are turned upright.
#pragma once

#include <optional>
#include <span>

#include "engine/cloud/point_cloud.hpp"
#include "engine/cloud/up.hpp"

namespace palpate {

/// Gives all points these coordinates of the file, one for each. Those that do not change keep theirs bit by bit.
void movePoints(PointCloud& cloud, std::span<const DVec3> coordinates);

/// The plane on which a model stands.
struct GroundPlane {
  DVec3 normal{0, 0, 1};  ///< unit, upwards
  double share = 0;       ///< of the model's surface that lies in it
};
/// Finds the ground: the plane with the most of the surface among those within 60 degrees of level that have almost all
/// of it above them (RANSAC: Fischler and Bolles 1981), fitted by least squares to the points in it. `up`: empty:
/// findUp(). Empty if no plane has a twentieth of the surface.
std::optional<GroundPlane> findGround(const PointCloud& cloud, std::optional<UpAxis> up = {});

/// Rotates a cloud about the middle of its box by the shortest rotation from `normal` to z, with its normals and
/// Gaussians.
void rotateToZ(PointCloud& cloud, const DVec3& normal);

}  // namespace palpate
