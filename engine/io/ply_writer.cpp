#include "engine/io/ply_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "engine/core/check.hpp"
#include "engine/io/row_output.hpp"

namespace palpate {
namespace {

constexpr std::array<const char*, 4> kColorNames{"red", "green", "blue", "alpha"};

/// The types in which a cloud is written.
struct Layout {
  ScalarType position, normal, color;
  std::size_t colorChannels;
  std::vector<const Attribute*> extra;
};

std::size_t channelsOf(const PointCloud& cloud) { return cloud.storedAs.alpha ? 4 : 3; }

// A lone nx of the input became an attribute; it is replaced once the cloud has normals.
bool propertyGivesWay(const PointCloud& cloud, const std::string& name) {
  const bool isNormal = name == "nx" || name == "ny" || name == "nz";
  const auto* end = kColorNames.begin() + channelsOf(cloud);
  return (cloud.hasNormals() && isNormal) || (cloud.hasColors() && std::find(kColorNames.begin(), end, name) != end);
}

Layout layoutOf(const PointCloud& cloud, bool doubles) {
  const StoredAs& stored = cloud.storedAs;
  const bool wide =
      doubles || stored.position == ScalarType::f64 || cloud.origin != DVec3(0) || !cloud.exactPositions.empty();
  Layout layout{wide ? ScalarType::f64 : ScalarType::f32, stored.normal, stored.color, channelsOf(cloud), {}};
  for (const Attribute& attribute : cloud.extra)
    if (!propertyGivesWay(cloud, attribute.name)) layout.extra.push_back(&attribute);
  return layout;
}

void writeHeader(RowOutput& out, const PointCloud& cloud, const Layout& layout, const CloudWriteOptions& options) {
  const auto property = [&](ScalarType type, std::string_view name) {
    out.headerLine(fmt::format("property {} {}", plyName(type), name));
  };
  out.headerLine("ply");
  out.headerLine(options.ascii ? "format ascii 1.0" : "format binary_little_endian 1.0");
  for (const std::string& comment : cloud.storedAs.comments) out.headerLine(comment);
  out.headerLine(fmt::format("element vertex {}", cloud.size()));
  for (const char* name : {"x", "y", "z"}) property(layout.position, name);
  if (cloud.hasNormals())
    for (const char* name : {"nx", "ny", "nz"}) property(layout.normal, name);
  if (cloud.hasColors())
    for (std::size_t k = 0; k < layout.colorChannels; ++k) property(layout.color, kColorNames[k]);
  for (const Attribute* attribute : layout.extra) property(attribute->type, attribute->name);
  if (options.triangles) {
    out.headerLine(fmt::format("element face {}", options.triangles->size()));
    out.headerLine("property list uchar int vertex_indices");
  }
  out.headerLine("end_header");
}

void writeColor(RowOutput& out, ScalarType type, std::uint8_t channel) {
  if (type == ScalarType::u8)
    out.value(channel);
  else if (type == ScalarType::u16)
    out.value(static_cast<std::uint16_t>(channel * 257));
  else
    out.real(type, channel / 255.0);
}

void writeTriangles(RowOutput& out, const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  for (const auto& triangle : triangles) {
    out.value(std::uint8_t{3});
    for (const std::uint32_t corner : triangle) out.value(static_cast<std::int32_t>(corner));
    out.endRow();
  }
}

void checkSizes(const PointCloud& cloud) {
  PALPATE_CHECK(!cloud.hasNormals() || cloud.normals.size() == cloud.size());
  PALPATE_CHECK(!cloud.hasColors() || cloud.colors.size() == cloud.size());
  PALPATE_CHECK(cloud.exactPositions.empty() || cloud.exactPositions.size() == cloud.size());
  for (const Attribute& attribute : cloud.extra)
    PALPATE_CHECK_EQ(attribute.data.size(), cloud.size() * sizeOf(attribute.type));
}

}  // namespace

std::vector<std::string> namesGivingWay(const PointCloud& cloud) {
  std::vector<std::string> names;
  for (const Attribute& attribute : cloud.extra)
    if (propertyGivesWay(cloud, attribute.name)) names.push_back(attribute.name);
  return names;
}

std::vector<const Attribute*> attributesBeside(const PointCloud& cloud) {
  std::vector<const Attribute*> others;
  for (const Attribute& attribute : cloud.extra)
    if (!propertyGivesWay(cloud, attribute.name)) others.push_back(&attribute);
  return others;
}

bool needsDoubles(const PointCloud& cloud, const CloudWriteOptions& options) {
  return options.doubles || cloud.storedAs.position == ScalarType::f64 || cloud.origin != DVec3(0) ||
         !cloud.exactPositions.empty();
}

void writePly(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options) {
  checkSizes(cloud);
  const Layout layout = layoutOf(cloud, options.doubles);
  RowOutput out(path, options.ascii);
  writeHeader(out, cloud, layout, options);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (options.progress && i % kBetweenReports == 0)
      options.progress(static_cast<double>(i) / static_cast<double>(cloud.size()));
    const DVec3 position = cloud.fileCoordinates(i);
    for (int k = 0; k < 3; ++k) out.real(layout.position, position[k]);
    if (cloud.hasNormals())
      for (int k = 0; k < 3; ++k) out.real(layout.normal, cloud.normals[i][k]);
    if (cloud.hasColors())
      for (std::size_t k = 0; k < layout.colorChannels; ++k) writeColor(out, layout.color, cloud.colors[i][k]);
    for (const Attribute* attribute : layout.extra) {
      visitScalar(attribute->type, [&]<class T>(std::type_identity<T>) {
        out.value(loadScalar<T>(attribute->data.data() + i * sizeof(T)));
      });
    }
    out.endRow();
  }
  if (options.triangles) writeTriangles(out, *options.triangles);
  out.finish(options.keptAs);
}

}  // namespace palpate
