#include "engine/io/column_names.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/io/text_number.hpp"

#include <fmt/ranges.h>

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

using Alias = std::pair<std::string_view, std::string_view>;

// Names used by surveyors, PCL, ParaView, VeloView, pandas and Blender.
constexpr std::array kAliases{
    Alias{"easting", "x"},      Alias{"east", "x"},
    Alias{"pos_x", "x"},        Alias{"position_x", "x"},
    Alias{"coord_x", "x"},      Alias{"points:0", "x"},
    Alias{"points_0", "x"},     Alias{"northing", "y"},
    Alias{"north", "y"},        Alias{"pos_y", "y"},
    Alias{"position_y", "y"},   Alias{"coord_y", "y"},
    Alias{"points:1", "y"},     Alias{"points_1", "y"},
    Alias{"elevation", "z"},    Alias{"height", "z"},
    Alias{"altitude", "z"},     Alias{"pos_z", "z"},
    Alias{"position_z", "z"},   Alias{"coord_z", "z"},
    Alias{"points:2", "z"},     Alias{"points_2", "z"},
    Alias{"rgb:0", "red"},      Alias{"rgb:1", "green"},
    Alias{"rgb:2", "blue"},     Alias{"normals:0", "nx"},
    Alias{"normals:1", "ny"},   Alias{"normals:2", "nz"},
    Alias{"colour_r", "red"},   Alias{"colour_g", "green"},
    Alias{"color_r", "red"},    Alias{"color_g", "green"},
    Alias{"color_b", "blue"},   Alias{"colour_b", "blue"},
    Alias{"elev", "z"},         Alias{"points_m_xyz:0", "x"},
    Alias{"x_coord", "x"},      Alias{"points_m_xyz:1", "y"},
    Alias{"y_coord", "y"},      Alias{"points_m_xyz:2", "z"},
    Alias{"z_coord", "z"},      Alias{"xcoord", "x"},
    Alias{"ycoord", "y"},       Alias{"zcoord", "z"},
    Alias{"rechtswert", "x"},   Alias{"hochwert", "y"},
    Alias{"eastings", "x"},     Alias{"northings", "y"},
    Alias{"x coordinate", "x"}, Alias{"y coordinate", "y"},
    Alias{"z coordinate", "z"}, Alias{"rechts", "x"},
    Alias{"hoch", "y"},         Alias{"höhe", "z"},
    Alias{"rot", "r"},          Alias{"grün", "g"},
    Alias{"gruen", "g"},        Alias{"blau", "b"},
    Alias{"hoehe", "z"},        Alias{"intensität", "intensity"},
};

using UnitName = std::pair<std::string_view, LengthUnit>;
constexpr std::array<UnitName, 10> kUnitNames{{{"mm", LengthUnit::mm},
                                               {"cm", LengthUnit::cm},
                                               {"m", LengthUnit::m},
                                               {"meter", LengthUnit::m},
                                               {"metre", LengthUnit::m},
                                               {"meters", LengthUnit::m},
                                               {"metres", LengthUnit::m},
                                               {"in", LengthUnit::inch},
                                               {"ft", LengthUnit::foot},
                                               {"feet", LengthUnit::foot}}};

std::string lower(std::string_view name) {
  std::string text(name);
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

const UnitName* unitNamed(std::string_view name) {
  const auto found = std::ranges::find(kUnitNames, name, &UnitName::first);
  return found == kUnitNames.end() ? nullptr : &*found;
}

/// The meaning of a lower-case name: of an axis or of another alias; empty if unknown.
std::string_view meaningOf(std::string_view name) {
  for (const std::string_view axis : {"x", "y", "z"})
    if (name == axis) return axis;
  const auto alias = std::ranges::find(kAliases, name, &Alias::first);
  return alias == kAliases.end() ? std::string_view{} : alias->second;
}

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

std::string sharedColumnName(std::string_view name) {
  std::string shared = lower(name.substr(0, name.find_first_of("[(")));
  while (!shared.empty() && (shared.back() == ' ' || shared.back() == '_')) shared.pop_back();
  if (shared.empty()) shared = lower(name);
  for (const char axis : {'x', 'y', 'z'})
    for (const std::string_view normal : {"normal_", "normal", "normals_", "norm_", "n_"})
      if (shared.size() == normal.size() + 1 && shared.starts_with(normal) && shared.back() == axis) return {'n', axis};
  if (const std::string_view meaning = meaningOf(shared); !meaning.empty()) return std::string(meaning);
  const std::size_t unit = shared.find_last_of("_ ");
  if (unit != shared.npos && unitNamed(std::string_view(shared).substr(unit + 1)))
    if (const std::string_view meaning = meaningOf(std::string_view(shared).substr(0, unit)); !meaning.empty())
      return std::string(meaning);
  return shared;
}

void nameShortAxes(std::vector<std::string>& shared) {
  constexpr std::array<Alias, 7> kShortAxes{
      {{"e", "x"}, {"n", "y"}, {"h", "z"}, {"el", "z"}, {"x1", "x"}, {"y1", "y"}, {"z1", "z"}}};
  for (const auto& [name, axis] : kShortAxes) {
    if (std::ranges::find(shared, axis) != shared.end()) continue;
    const auto found = std::ranges::find(shared, name);
    if (found != shared.end()) *found = axis;
  }
}

LengthUnit unitInName(std::string_view name) {
  const std::string text = lower(name);
  if (text.starts_with("points_m_")) return LengthUnit::m;
  const std::size_t begin = text.find_first_of("[("), end = text.find_first_of("])");
  const std::size_t last = text.find_last_of("_ ");
  const std::string_view unit = begin != text.npos && end != text.npos && begin < end
                                    ? std::string_view(text).substr(begin + 1, end - begin - 1)
                                : last != text.npos ? std::string_view(text).substr(last + 1)
                                                    : std::string_view{};
  const UnitName* found = unitNamed(unit);
  return found ? found->second : LengthUnit::unknown;
}

std::string utf8Name(std::string_view name) {
  bool isUtf8 = true;
  for (std::size_t at = 0; isUtf8 && at < name.size();) {
    const auto byte = static_cast<unsigned char>(name[at++]);
    std::size_t more = byte < 0x80 ? 0 : byte >= 0xf0 ? 3 : byte >= 0xe0 ? 2 : 1;
    isUtf8 = byte < 0x80 || (byte >= 0xc2 && byte < 0xf5);
    for (; isUtf8 && more > 0; --more, ++at)
      isUtf8 = at < name.size() && (static_cast<unsigned char>(name[at]) & 0xc0) == 0x80;
  }
  if (isUtf8) return std::string(name);
  std::string text;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80)
      text += c;
    else
      text += {static_cast<char>(0xc0 | byte >> 6), static_cast<char>(0x80 | (byte & 0x3f))};
  }
  return text;
}

}  // namespace palpate
