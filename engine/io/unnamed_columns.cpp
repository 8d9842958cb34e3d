#include "engine/io/unnamed_columns.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/io/text_number.hpp"

namespace palpate {

namespace {

using Group = UnnamedColumns::Group;

std::size_t widthOf(Group group) { return group == Group::scalar ? 1 : 3; }

bool has(const UnnamedColumns::Layout& layout, Group group) { return std::ranges::find(layout, group) != layout.end(); }

/// First column of the group.
std::size_t columnOf(const UnnamedColumns::Layout& layout, Group group) {
  std::size_t at = 3;
  for (const Group one : layout) {
    if (one == group) break;
    at += widthOf(one);
  }
  return at;
}

std::string listed(const std::vector<std::string>& names) { return fmt::format("{}", fmt::join(names, ",")); }

}  // namespace

UnnamedColumns::UnnamedColumns(std::size_t columns, bool scalarFirst)
    : columns_(columns), triples_(columns), scalarFirst_(scalarFirst) {
  for (unsigned which = 0; which < 8; ++which) {
    Layout layout;
    for (const Group group : {Group::normal, Group::color, Group::scalar})
      if (which >> static_cast<unsigned>(group) & 1) layout.push_back(group);
    std::size_t width = 3;
    for (const Group group : layout) width += widthOf(group);
    if (width != columns) continue;
    do layouts_.push_back(layout);
    while (std::ranges::next_permutation(layout).found);
  }
}

void UnnamedColumns::take(const std::vector<std::string_view>& words) {
  constexpr double kUnitTolerance = 0.01;  // tolerance for rounding
  const auto valueOf = [&](std::size_t k) {
    return textNumber<double>(words[k]).value_or(std::numeric_limits<double>::quiet_NaN());
  };
  double last = 0, beforeLast = 0;  // squares of the two columns before
  for (std::size_t k = 3; k < columns_.size(); ++k) {
    const double value = valueOf(k), square = value * value;
    Column& column = columns_[k];
    column.most = std::max(column.most, value);
    if (value < 0 || value > 1) column.shares = false;
    if (value < 0 || value > 255 || value != std::trunc(value)) column.bytes = false;
    if (words[k].find_first_of(".eE") != std::string_view::npos) column.whole = false;
    if (k >= 5) {
      Triple& triple = triples_[k - 2];
      const double squared = square + last + beforeLast;
      if (std::isfinite(squared) && squared > 0) {
        triple.any = true;
        if (!(std::abs(std::sqrt(squared) - 1) < kUnitTolerance)) triple.unit = false;
      }
    }
    beforeLast = last;
    last = square;
  }
  const double number = valueOf(0);
  countsUp_ = countsUp_ && number == std::trunc(number) && (rows_ == 0 || number == number_ + 1);
  number_ = number;
  ++rows_;
}

bool UnnamedColumns::allows(const Layout& layout) const {
  if (has(layout, Group::normal)) {
    const Triple& triple = triples_[columnOf(layout, Group::normal)];
    if (!triple.unit || !triple.any) return false;
  }
  if (!has(layout, Group::color)) return true;
  const auto first = columns_.begin() + static_cast<std::ptrdiff_t>(columnOf(layout, Group::color));
  return std::all_of(first, first + 3, [](const Column& column) { return column.shares; }) ||
         std::all_of(first, first + 3, [](const Column& column) { return column.bytes; });
}

/// Whether the scalar is a class or a label: few whole numbers, while all colours reach further.
bool UnnamedColumns::hasLabel(const Layout& layout) const {
  constexpr double kMaxLabel = 31;
  const auto first = columns_.begin() + static_cast<std::ptrdiff_t>(columnOf(layout, Group::color));
  return columns_[columnOf(layout, Group::scalar)].most <= kMaxLabel &&
         std::all_of(first, first + 3, [](const Column& column) { return column.most > kMaxLabel; });
}

UnnamedColumns::Layout UnnamedColumns::layout(std::string& why) const {
  constexpr std::size_t kFewRows = 3;
  std::vector<Layout> fitting;
  std::ranges::copy_if(layouts_, std::back_inserter(fitting), [&](const Layout& one) { return allows(one); });
  const auto keepOnly = [&](auto&& is) {
    if (std::ranges::any_of(fitting, is)) std::erase_if(fitting, [&](const Layout& one) { return !is(one); });
  };
  // Columns of unit length in all rows are normals; then the format decides, then the range of the numbers.
  keepOnly([](const Layout& one) { return has(one, Group::normal); });
  const auto isMixed = [](const Layout& one) { return has(one, Group::scalar) && has(one, Group::color); };
  keepOnly([&](const Layout& one) {
    return isMixed(one) && scalarFirst_ && columnOf(one, Group::scalar) < columnOf(one, Group::color);
  });
  if (fitting.size() > 1) keepOnly([&](const Layout& one) { return isMixed(one) && hasLabel(one); });
  const std::size_t count = columns_.size();
  if (fitting.empty()) {
    why = fmt::format("columns 4 to {} have no names, and are neither unit normals nor colours throughout", count);
    return {};
  }
  if (fitting.size() > 1) {
    why = fmt::format("columns 4 to {} have no names, and may be {} or {}", count, listed(namesOf(fitting[0])),
                      listed(namesOf(fitting[1])));
    return {};
  }
  if (countsUp_ && rows_ >= kFewRows && !has(fitting[0], Group::normal)) {
    why = fmt::format("column 1 counts up by one and may number the points: number,x,y,z{} or {}",
                      count > 4 ? ",..." : "", listed(namesOf(fitting[0])));
    return {};
  }
  return fitting[0];
}

bool UnnamedColumns::hasWholeColors() const {
  std::string why;
  const Layout found = layout(why);
  if (!has(found, Group::color)) return true;
  const auto first = columns_.begin() + static_cast<std::ptrdiff_t>(columnOf(found, Group::color));
  return std::all_of(first, first + 3, [](const Column& column) { return column.whole; });
}

std::vector<std::string> namesOf(const UnnamedColumns::Layout& layout) {
  std::vector<std::string> names{"x", "y", "z"};
  for (const Group group : layout) {
    if (group == Group::normal) names.insert(names.end(), {"nx", "ny", "nz"});
    if (group == Group::color) names.insert(names.end(), {"red", "green", "blue"});
    if (group == Group::scalar) {
      const bool afterColors = std::ranges::find(names, "blue") != names.end();
      names.emplace_back(afterColors ? "scalar" : "intensity");
    }
  }
  return names;
}

}  // namespace palpate
