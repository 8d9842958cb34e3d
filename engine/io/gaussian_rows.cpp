#include "engine/io/gaussian_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/error.hpp"
#include "engine/core/parallel.hpp"

namespace palpate {

namespace {

constexpr float kFlat = -100;      // logarithm of a deviation that is none
constexpr double kLargest = 1e30;  // of coordinates, as of other clouds
constexpr double kLargestSingle = std::numeric_limits<float>::max();

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
    const bool normal = column.name == "nx" || column.name == "ny" || column.name == "nz";  // all zero, by custom
    if (column.group == Group::none && isFloating(column.type)) {
      Run* last = onlyLookedAt_.empty() ? nullptr : &onlyLookedAt_.back();
      if (last && last->type == column.type && last->offset + last->count * sizeOf(last->type) == column.offset)
        ++last->count;
      else
        onlyLookedAt_.push_back({column.offset, 1, column.type});
    }
    if (column.group == Group::none && !normal && !column.name.starts_with("f_rest_")) unused_.push_back(column.name);
  }
}

void GaussianRows::reserve(std::uint64_t promised) {
  constexpr std::uint64_t kMostRows = std::uint64_t{1} << 27;  // a sparse file is long without holding anything
  const auto rows = static_cast<std::size_t>(std::min(promised, kMostRows));
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
std::optional<PlyRowSink::BadRow> GaussianRows::storeColumn(const Column& column, const std::byte* rows, Range range) {
  if constexpr (std::is_floating_point_v<T>) {
    const double largest = column.group == Group::center ? kLargest : kLargestSingle;
    for (std::size_t r = range.begin; r < range.end; ++r) {
      const double value = loadScalar<T, kSwap>(rows + r * rowBytes_ + column.offset);
      if (!(std::abs(value) <= largest))
        return BadRow{r, fmt::format("'{}' of vertex {} is {}; expected a finite number{}", column.name, count_ + r + 1,
                                     value, column.group == Group::center ? " below 1e30" : "")};
      if (column.group != Group::none) store(column, count_ + r, value);
    }
  }
  return std::nullopt;
}

template <class T, bool kSwap>
bool GaussianRows::isFinite(const Run& run, const std::byte* rows, Range range) const {
  unsigned wrong = 0;  // without a branch, so that compilers let numbers go together
  if constexpr (std::is_floating_point_v<T>)
    for (std::size_t r = range.begin; r < range.end; ++r)
      for (std::size_t k = 0; k < run.count; ++k) {
        const T value = loadScalar<T, kSwap>(rows + r * rowBytes_ + run.offset + k * sizeof(T));
        wrong |= std::abs(value) <= static_cast<T>(kLargestSingle) ? 0 : 1;
      }
  return wrong == 0;
}

template <bool kSwap>
std::optional<PlyRowSink::BadRow> GaussianRows::storeRows(const std::byte* rows, Range range) {
  std::fill(&scene_.logScales[count_ + range.begin], scene_.logScales.data() + count_ + range.end, Vec3(kFlat));
  const bool restIsFinite = std::ranges::all_of(onlyLookedAt_, [&](const Run& run) {
    return visitScalar(run.type, [&]<class T>(std::type_identity<T>) { return isFinite<T, kSwap>(run, rows, range); });
  });
  std::optional<BadRow> first;
  for (const Column& column : columns_) {
    if (column.group == Group::none && restIsFinite) continue;
    const auto bad = visitScalar(
        column.type, [&]<class T>(std::type_identity<T>) { return storeColumn<T, kSwap>(column, rows, range); });
    if (bad && (!first || bad->row < first->row)) first = bad;
  }
  return first;
}

std::optional<PlyRowSink::BadRow> GaussianRows::append(const std::byte* rows, std::size_t count, bool swapBytes) {
  constexpr std::size_t kAtOnce = 64;  // rows that a processor's nearest memory holds, for going along their columns
  const std::size_t total = count_ + count;
  scene_.centers.resize(total);
  scene_.logScales.resize(total);
  scene_.rotations.resize(total);
  scene_.opacityLogits.resize(total);
  scene_.colorHarmonics.resize(total);
  const ParallelRanges ranges(count, 0);
  std::vector<std::optional<BadRow>> bad(ranges.count());
  parallelParts(ranges.count(), [&](std::size_t k) {
    for (std::size_t row = ranges.begin(k); row < ranges.end(k) && !bad[k]; row += kAtOnce) {
      const Range some{row, std::min(row + kAtOnce, ranges.end(k))};
      bad[k] = swapBytes ? storeRows<true>(rows, some) : storeRows<false>(rows, some);
    }
  });
  count_ = total;
  const auto first = std::ranges::find_if(bad, [](const auto& row) { return row.has_value(); });
  return first == bad.end() ? std::nullopt : *first;
}

}  // namespace palpate
