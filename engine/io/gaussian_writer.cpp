#include "engine/io/gaussian_writer.hpp"

#include <cmath>

#include "engine/cloud/spacing.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/io/row_output.hpp"

namespace palpate {

namespace {

constexpr double kWidth = 0.75, kThickness = 0.075;  // deviations, in mean spacings
constexpr double kOpacity = 0.99;
constexpr double kHarmonic = 0.28209479177387814;  // the spherical harmonic of degree 0

/// The rotation from z to `normal`, w x y z.
DVec4 rotationTo(const DVec3& normal) {
  const bool opposite = normal.z < -1 + 1e-9;
  const DVec4 q = opposite ? DVec4(0, 1, 0, 0) : DVec4(1 + normal.z, -normal.y, normal.x, 0);
  return q / glm::length(q);
}

void writeHeader(RowOutput& out, const PointCloud& cloud, bool ascii) {
  out.headerLine("ply");
  out.headerLine(ascii ? "format ascii 1.0" : "format binary_little_endian 1.0");
  for (const std::string& comment : cloud.storedAs.comments) out.headerLine(comment);
  out.headerLine(fmt::format("element vertex {}", cloud.size()));
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0",
                           "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"})
    out.headerLine(fmt::format("property float {}", name));
  out.headerLine("end_header");
}

}  // namespace

void writeGaussians(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options) {
  if (!cloud.hasNormals() && !cloud.empty())
    throw FileError(path, "Gaussians require normals, and these points have none; estimate them first");
  const double spacing = meanSpacing(cloud);
  const double across = spacing > 0 ? spacing : 1;  // any value works for a single point
  const std::array<float, 3> scales{static_cast<float>(std::log(kWidth * across)),
                                    static_cast<float>(std::log(kWidth * across)),
                                    static_cast<float>(std::log(kThickness * across))};
  RowOutput out(path, options.ascii);
  writeHeader(out, cloud, options.ascii);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (options.progress && i % kBetweenReports == 0)
      options.progress(static_cast<double>(i) / static_cast<double>(cloud.size()));
    const auto three = [&](const DVec3& v) {
      for (int k = 0; k < 3; ++k) out.value(static_cast<float>(v[k]));
    };
    const DVec3 normal(cloud.normals[i]);
    DVec3 color(0.5);
    if (cloud.hasColors()) color = DVec3(cloud.colors[i][0], cloud.colors[i][1], cloud.colors[i][2]) / 255.0;
    three(cloud.fileCoordinates(i));
    three(normal);
    three((color - 0.5) / kHarmonic);
    out.value(static_cast<float>(std::log(kOpacity / (1 - kOpacity))));
    for (const float scale : scales) out.value(scale);
    const DVec4 rotation = rotationTo(normal);
    for (int k = 0; k < 4; ++k) out.value(static_cast<float>(rotation[k]));
    out.endRow();
  }
  out.finish(options.keptAs);
}

std::vector<std::string> lacksOfGaussians(const PointCloud& cloud) {
  std::vector<std::string> lost;
  if (cloud.origin != DVec3(0) || !cloud.exactPositions.empty())
    lost.emplace_back("coordinates finer than single precision");
  if (cloud.hasColors() && cloud.storedAs.alpha) lost.emplace_back("the alpha of colours");
  for (const Attribute& attribute : cloud.extra) lost.push_back(fmt::format("the attribute '{}'", attribute.name));
  return lost;
}

}  // namespace palpate
