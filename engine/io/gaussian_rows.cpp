#include "engine/io/gaussian_rows.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/core/error.hpp"

namespace palpate {

namespace {

bool hasScalar(const PlyElement& vertex, std::string_view name) {
  return std::ranges::any_of(vertex.properties,
                             [&](const PlyProperty& property) { return !property.isList && property.name == name; });
}

}  // namespace

bool GaussianRows::areGaussians(const PlyElement& vertex) {
  return hasScalar(vertex, "scale_0") && hasScalar(vertex, "rot_0");
}

GaussianRows::GaussianRows(const std::filesystem::path& file, const PlyElement& vertex) {
  for (const PlyProperty& property : vertex.properties) {
    if (property.isList) {
      lists_.push_back(property.name);
      continue;
    }
    columns_.push_back({property.name, property.type, rowBytes_});
    rowBytes_ += sizeOf(property.type);
  }
  const auto require = [&](const std::string& name) {
    const auto column = std::ranges::find(columns_, name, &GaussianRecords::Column::name);
    if (column == columns_.end())
      throw FileError::atLine(file, vertex.line,
                              fmt::format("the vertex element has scale_0 and rot_0, as Gaussians have, but no scalar "
                                          "property '{}'; Gaussians have x y z, f_dc_0 to 2, opacity, scale_0 to 2 and "
                                          "rot_0 to 3",
                                          name));
    if (!isFloating(column->type))
      throw FileError::atLine(file, vertex.line,
                              fmt::format("property '{}' of Gaussians is of type {}; expected float or double", name,
                                          plyName(column->type)));
  };
  const auto requireAll = [&](int count, std::string_view name) {
    for (int k = 0; k < count; ++k) require(fmt::format("{}{}", name, k));
  };
  require("x"), require("y"), require("z");
  requireAll(3, "f_dc_");
  require("opacity");
  requireAll(hasScalar(vertex, "scale_2") ? 3 : 2, "scale_");
  requireAll(4, "rot_");
}

void GaussianRows::reserve(std::uint64_t promised) {
  constexpr std::uint64_t kMax_bytes = std::uint64_t{1} << 35;  // a sparse file may be long without containing data
  rows_.reserve(static_cast<std::size_t>(std::min(promised, kMax_bytes / rowBytes_)) * rowBytes_);
}

std::optional<PlyRowSink::BadRow> GaussianRows::append(const std::byte* rows, std::size_t count, bool swapBytes) {
  const std::size_t begin = rows_.size();
  rows_.insert(rows_.end(), rows, rows + count * rowBytes_);
  for (std::size_t i = 0; swapBytes && i < count; ++i)
    for (const GaussianRecords::Column& column : columns_) {
      const auto value = rows_.begin() + static_cast<std::ptrdiff_t>(begin + i * rowBytes_ + column.offset);
      std::reverse(value, value + static_cast<std::ptrdiff_t>(sizeOf(column.type)));
    }
  return std::nullopt;
}

}  // namespace palpate
