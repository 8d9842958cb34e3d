#include "engine/io/gaussian_rows.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/core/error.hpp"
#include "engine/core/parallel.hpp"

namespace palpate {

namespace {

constexpr float kFlat = -100;  // logarithm of a deviation of zero

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
      unused_.push_back(property.name);
      continue;
    }
    columns_.push_back({property.name, rowBytes_, property.type, Group::none, 0});
    rowBytes_ += sizeOf(property.type);
  }
  const auto take = [&](Group group, int component, const std::string& name) {
    const auto column = std::ranges::find(columns_, name, &Column::name);
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
    column->group = group;
    column->component = component;
  };
  const auto takeAll = [&](Group group, int count, std::string_view name) {
    for (int k = 0; k < count; ++k) take(group, k, fmt::format("{}{}", name, k));
  };
  take(Group::center, 0, "x"), take(Group::center, 1, "y"), take(Group::center, 2, "z");
  takeAll(Group::color, 3, "f_dc_");
  take(Group::opacity, 0, "opacity");
  takeAll(Group::logScale, hasScalar(vertex, "scale_2") ? 3 : 2, "scale_");
  takeAll(Group::rotation, 4, "rot_");
  for (const Column& column : columns_) {
    const bool normal = column.name == "nx" || column.name == "ny" || column.name == "nz";  // zero by convention
    if (column.group == Group::none && !normal && !column.name.starts_with("f_rest_")) unused_.push_back(column.name);
  }
}

void GaussianRows::reserve(std::uint64_t promised) {
  constexpr std::uint64_t kMaxRows = std::uint64_t{1} << 27;  // a sparse file may be long without containing data
  const auto rows = static_cast<std::size_t>(std::min(promised, kMaxRows));
  scene_.centers.reserve(rows);
  scene_.logScales.reserve(rows);
  scene_.rotations.reserve(rows);
  scene_.opacityLogits.reserve(rows);
  scene_.colorHarmonics.reserve(rows);
}

void GaussianRows::store(const Column& column, std::size_t i, double value) {
  const auto single = static_cast<float>(value);
  switch (column.group) {
    case Group::center:
      scene_.centers[i][column.component] = value;
      break;
    case Group::logScale:
      scene_.logScales[i][column.component] = single;
      break;
    case Group::rotation:
      scene_.rotations[i][column.component] = single;
      break;
    case Group::opacity:
      scene_.opacityLogits[i] = single;
      break;
    case Group::color:
      scene_.colorHarmonics[i][column.component] = single;
      break;
    case Group::none:
      break;
  }
}

template <class T, bool kSwap>
void GaussianRows::storeColumn(const Column& column, const std::byte* rows, Range range) {
  for (std::size_t r = range.begin; r < range.end; ++r)
    store(column, count_ + r, static_cast<double>(loadScalar<T, kSwap>(rows + r * rowBytes_ + column.offset)));
}

template <bool kSwap>
void GaussianRows::storeRows(const std::byte* rows, Range range) {
  std::fill(&scene_.logScales[count_ + range.begin], scene_.logScales.data() + count_ + range.end, Vec3(kFlat));
  for (const Column& column : columns_)
    if (column.group != Group::none)
      visitScalar(column.type, [&]<class T>(std::type_identity<T>) { storeColumn<T, kSwap>(column, rows, range); });
}

std::optional<PlyRowSink::BadRow> GaussianRows::append(const std::byte* rows, std::size_t count, bool swapBytes) {
  constexpr std::size_t kAtOnce = 64;  // rows that fit into the first-level cache, for column-wise access
  const std::size_t total = count_ + count;
  scene_.centers.resize(total);
  scene_.logScales.resize(total);
  scene_.rotations.resize(total);
  scene_.opacityLogits.resize(total);
  scene_.colorHarmonics.resize(total);
  const ParallelRanges ranges(count, 0);
  parallelParts(ranges.count(), [&](std::size_t k) {
    for (std::size_t row = ranges.begin(k); row < ranges.end(k); row += kAtOnce) {
      const Range some{row, std::min(row + kAtOnce, ranges.end(k))};
      swapBytes ? storeRows<true>(rows, some) : storeRows<false>(rows, some);
    }
  });
  count_ = total;
  return std::nullopt;
}

}  // namespace palpate
