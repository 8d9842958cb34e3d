#include "engine/io/npy_writer.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/core/counted.hpp"
#include "engine/io/ply_writer.hpp"
#include "engine/io/row_output.hpp"
#include "engine/io/zip_output.hpp"

namespace palpate {

namespace {

constexpr std::array<const char*, 10> kCodes{"|i1", "|u1", "<i2", "<u2", "<i4", "<u4", "<f4", "<f8", "<i8", "<u8"};

/// The header of an array, padded with blanks so that numbers begin at a multiple of 64. `type` and `shape`: in Python
/// syntax.
std::string headerOf(const std::string& type, const std::string& shape) {
  std::string text = fmt::format("{{'descr': {}, 'fortran_order': False, 'shape': {}, }}", type, shape);
  const bool late = text.size() + 64 > 65535;  // version 1 stores the length in 16 bits
  const std::size_t before = late ? 12 : 10;
  text += std::string(63 - (before + text.size()) % 64, ' ');
  text += '\n';
  std::string out = std::string("\x93NUMPY", 6) + (late ? '\2' : '\1') + '\0';
  for (std::size_t k = 0; k < (late ? 4 : 2); ++k) out += static_cast<char>(text.size() >> (8 * k) & 0xff);
  return out + text;
}

bool canBeQuoted(const std::string& name) { return name.find_first_of("'\\") == name.npos; }

std::string fieldOf(std::string name, ScalarType type) {
  if (!canBeQuoted(name))
    for (char& c : name)
      if (c == '\'' || c == '\\') c = '_';
  return fmt::format("('{}', '{}'), ", name, kCodes[static_cast<std::size_t>(type)]);
}

void report(const CloudWriteOptions& options, double share) {
  if (options.progress) options.progress(share);
}

/// Appends numbers in little-endian order.
class ArrayBytes {
 public:
  ArrayBytes(const std::string& type, const std::string& shape, std::size_t bytes) {
    const std::string header = headerOf(type, shape);
    bytes_.reserve(header.size() + bytes);
    const auto* begin = reinterpret_cast<const std::byte*>(header.data());
    bytes_.insert(bytes_.end(), begin, begin + header.size());
  }
  template <class T>
  void value(T number) {
    auto bytes = std::bit_cast<std::array<std::byte, sizeof(T)>>(number);
    if constexpr (std::endian::native == std::endian::big) std::reverse(bytes.begin(), bytes.end());
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

ArrayBytes arrayOf(const char* type, const PointCloud& cloud, std::size_t columns, std::size_t rowBytes) {
  const std::string shape =
      columns == 1 ? fmt::format("({},)", cloud.size()) : fmt::format("({}, {})", cloud.size(), columns);
  return {fmt::format("'{}'", type), shape, cloud.size() * rowBytes};
}

ArrayBytes placesOf(const PointCloud& cloud, bool wide) {
  ArrayBytes array = arrayOf(wide ? "<f8" : "<f4", cloud, 3, wide ? 24 : 12);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const DVec3 place = cloud.fileCoordinates(i);
    for (int k = 0; k < 3; ++k) {
      if (wide)
        array.value(place[k]);
      else
        array.value(static_cast<float>(place[k]));
    }
  }
  return array;
}

ArrayBytes valuesOf(const PointCloud& cloud, const Attribute& attribute) {
  ArrayBytes array = arrayOf(kCodes[static_cast<std::size_t>(attribute.type)], cloud, 1, sizeOf(attribute.type));
  visitScalar(attribute.type, [&]<class T>(std::type_identity<T>) {
    for (std::size_t i = 0; i < cloud.size(); ++i) array.value(loadScalar<T>(attribute.data.data() + i * sizeof(T)));
  });
  return array;
}

/// Array names that have another meaning when read, and invalid member names.
bool isTakenInNpz(const std::string& name) {
  constexpr std::array kTaken{"xyz",     "points", "positions", "position", "pos", "vertices", "coords",
                              "normals", "normal", "colors",    "colours",  "rgb", "color",    "alpha"};
  return name.empty() || name.find_first_of("/\\") != name.npos || std::ranges::find(kTaken, name) != kTaken.end();
}

std::vector<std::string> lacksOf(const PointCloud& cloud) {
  std::vector<std::string> lost;
  if (!cloud.storedAs.comments.empty()) lost.emplace_back("comments");
  for (const std::string& name : namesGivingWay(cloud))
    lost.push_back(fmt::format("the field '{}', because another one is written under its name", name));
  return lost;
}

}  // namespace

void writeNpy(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options) {
  const ScalarType place = needsDoubles(cloud, options) ? ScalarType::f64 : ScalarType::f32;
  const std::vector<const Attribute*> extra = attributesBeside(cloud);
  std::string fields;
  for (const char* name : {"x", "y", "z"}) fields += fieldOf(name, place);
  if (cloud.hasNormals())
    for (const char* name : {"nx", "ny", "nz"}) fields += fieldOf(name, ScalarType::f32);
  if (cloud.hasColors())
    for (const char* name : {"red", "green", "blue"}) fields += fieldOf(name, ScalarType::u8);
  if (cloud.hasColors() && cloud.storedAs.alpha) fields += fieldOf("alpha", ScalarType::u8);
  for (const Attribute* attribute : extra) fields += fieldOf(attribute->name, attribute->type);
  RowOutput out(path, false);
  out.bytes(headerOf("[" + fields + "]", fmt::format("({},)", cloud.size())));
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (i % kBetweenReports == 0) report(options, static_cast<double>(i) / static_cast<double>(cloud.size()));
    const DVec3 position = cloud.fileCoordinates(i);
    for (int k = 0; k < 3; ++k) out.real(place, position[k]);
    for (int k = 0; cloud.hasNormals() && k < 3; ++k) out.value(cloud.normals[i][k]);
    for (std::size_t k = 0; cloud.hasColors() && k < (cloud.storedAs.alpha ? 4u : 3u); ++k)
      out.value(cloud.colors[i][k]);
    for (const Attribute* attribute : extra)
      visitScalar(attribute->type, [&]<class T>(std::type_identity<T>) {
        out.value(loadScalar<T>(attribute->data.data() + i * sizeof(T)));
      });
    out.endRow();
  }
  out.finish(options.keptAs);
}

void writeNpz(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options) {
  ZipOutput out(path);
  const std::vector<const Attribute*> extra = attributesBeside(cloud);
  double done = 0;
  const auto add = [&](const std::string& name, const ArrayBytes& array) {
    out.add(name + ".npy", array.bytes());
    report(options, ++done / static_cast<double>(4 + extra.size()));
  };
  add("xyz", placesOf(cloud, needsDoubles(cloud, options)));
  if (cloud.hasNormals()) {
    ArrayBytes array = arrayOf("<f4", cloud, 3, 12);
    for (const Vec3& normal : cloud.normals)
      for (int k = 0; k < 3; ++k) array.value(normal[k]);
    add("normals", array);
  }
  if (cloud.hasColors()) {
    ArrayBytes array = arrayOf("|u1", cloud, 3, 3);
    for (const auto& color : cloud.colors)
      for (std::size_t k = 0; k < 3; ++k) array.value(color[k]);
    add("colors", array);
  }
  if (cloud.hasColors() && cloud.storedAs.alpha) {
    ArrayBytes array = arrayOf("|u1", cloud, 1, 1);
    for (const auto& color : cloud.colors) array.value(color[3]);
    add("alpha", array);
  }
  for (const Attribute* attribute : extra)
    if (!isTakenInNpz(attribute->name)) add(attribute->name, valuesOf(cloud, *attribute));
  out.finish(options.keptAs);
}

std::vector<std::string> lacksOfNpy(const PointCloud& cloud) {
  std::vector<std::string> lost = lacksOf(cloud);
  for (const Attribute& attribute : cloud.extra)
    if (!canBeQuoted(attribute.name)) lost.push_back(fmt::format("the quotes in the name {}", attribute.name));
  return lost;
}

std::vector<std::string> lacksOfNpz(const PointCloud& cloud) {
  std::vector<std::string> lost = lacksOf(cloud);
  for (const Attribute* attribute : attributesBeside(cloud))
    if (isTakenInNpz(attribute->name))
      lost.push_back(fmt::format("the attribute '{}', because the archive uses its name", attribute->name));
  return lost;
}

}  // namespace palpate
