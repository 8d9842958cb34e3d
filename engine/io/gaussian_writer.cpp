#include "engine/io/gaussian_writer.hpp"

#include <cmath>

#include "engine/cloud/shortest_rotation.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/io/row_output.hpp"

namespace palpate {

namespace {

constexpr double kWidth = 0.75, kThickness = 0.075;  // deviations, in mean spacings
constexpr double kOpacity = 0.99;

void writeHeader(RowOutput& out, std::span<const std::string> comments, bool ascii, std::size_t count,
                 std::span<const GaussianRecords::Column> columns) {
  out.headerLine("ply");
  out.headerLine(ascii ? "format ascii 1.0" : "format binary_little_endian 1.0");
  for (const std::string& comment : comments) out.headerLine(comment);
  out.headerLine(fmt::format("element vertex {}", count));
  for (const GaussianRecords::Column& column : columns)
    out.headerLine(fmt::format("property {} {}", plyName(column.type), column.name));
  out.headerLine("end_header");
}

std::vector<GaussianRecords::Column> columnsOfPoints() {
  std::vector<GaussianRecords::Column> columns;
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0",
                           "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"})
    columns.push_back({name, ScalarType::f32, 4 * columns.size()});
  return columns;
}

}  // namespace

void writeGaussians(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options) {
  if (const GaussianRecords* const records = gaussiansOf(cloud))
    return writeRecords(path, *records, cloud.storedAs.comments, options);
  if (!cloud.hasNormals() && !cloud.empty())
    throw FileError(path, "Gaussians require normals, and these points have none; estimate them first");
  const double spacing = meanSpacing(cloud);
  const double across = spacing > 0 ? spacing : 1;  // any value works for a single point
  const std::array<float, 3> scales{static_cast<float>(std::log(kWidth * across)),
                                    static_cast<float>(std::log(kWidth * across)),
                                    static_cast<float>(std::log(kThickness * across))};
  RowOutput out(path, options.ascii);
  writeHeader(out, cloud.storedAs.comments, options.ascii, cloud.size(), columnsOfPoints());
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
    three((color - 0.5) / kZeroHarmonic);
    out.value(static_cast<float>(std::log(kOpacity / (1 - kOpacity))));
    for (const float scale : scales) out.value(scale);
    const DQuat rotation = shortestRotation(DVec3(0, 0, 1), normal);
    for (const double part : {rotation.w, rotation.x, rotation.y, rotation.z}) out.value(static_cast<float>(part));
    out.endRow();
  }
  out.finish(options.keptAs);
}

void writeRecords(const std::filesystem::path& path, const GaussianRecords& records,
                  std::span<const std::string> comments, const CloudWriteOptions& options) {
  RowOutput out(path, options.ascii);
  writeHeader(out, comments, options.ascii, records.size(), records.columns);
  const bool asIs = !options.ascii && std::endian::native == std::endian::little;
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (options.progress && i % kBetweenReports == 0)
      options.progress(static_cast<double>(i) / static_cast<double>(records.size()));
    if (asIs) out.bytes({reinterpret_cast<const char*>(records.row(i)), records.rowBytes});
    for (std::size_t k = 0; !asIs && k < records.columns.size(); ++k)
      visitScalar(records.columns[k].type, [&]<class T>(std::type_identity<T>) {
        out.value(loadScalar<T>(records.row(i) + records.columns[k].offset));
      });
    out.endRow();
  }
  out.finish(options.keptAs);
}

std::vector<std::string> lacksOfGaussians(const PointCloud& cloud) {
  std::vector<std::string> lost;
  if (const GaussianRecords* const records = gaussiansOf(cloud)) {
    for (const Attribute& attribute : cloud.extra)
      if (!records->find(attribute.name))
        lost.push_back(
            fmt::format("'{}' of the felt surface (a splat file contains only splats; save a .las file to keep it)",
                        attribute.name));
    return lost;
  }
  if (cloud.origin != DVec3(0) || !cloud.exactPositions.empty())
    lost.emplace_back("coordinates finer than single precision");
  if (cloud.hasColors() && cloud.storedAs.alpha) lost.emplace_back("the alpha of colours");
  for (const Attribute& attribute : cloud.extra) lost.push_back(fmt::format("the attribute '{}'", attribute.name));
  return lost;
}

}  // namespace palpate
