#include "engine/io/column_names.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

namespace palpate {

namespace {

using Alias = std::pair<std::string_view, std::string_view>;

// Names used by surveyors, PCL, ParaView, pandas and Blender.
constexpr std::array<Alias, 33> kAliases{{
    {"easting", "x"},    {"east", "x"},        {"pos_x", "x"},      {"position_x", "x"}, {"coord_x", "x"},
    {"points:0", "x"},   {"points_0", "x"},    {"northing", "y"},   {"north", "y"},      {"pos_y", "y"},
    {"position_y", "y"}, {"coord_y", "y"},     {"points:1", "y"},   {"points_1", "y"},   {"elevation", "z"},
    {"height", "z"},     {"altitude", "z"},    {"pos_z", "z"},      {"position_z", "z"}, {"coord_z", "z"},
    {"points:2", "z"},   {"points_2", "z"},    {"rgb:0", "red"},    {"rgb:1", "green"},  {"rgb:2", "blue"},
    {"normals:0", "nx"}, {"normals:1", "ny"},  {"normals:2", "nz"}, {"colour_r", "red"}, {"colour_g", "green"},
    {"color_r", "red"},  {"color_g", "green"}, {"color_b", "blue"},
}};

}  // namespace

std::string sharedColumnName(std::string_view name) {
  std::string shared(name.substr(0, name.find_first_of("[(")));
  while (!shared.empty() && (shared.back() == ' ' || shared.back() == '_')) shared.pop_back();
  if (shared.empty()) shared = name;
  for (char& c : shared) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const char axis : {'x', 'y', 'z'})
    for (const std::string_view normal : {"normal_", "normal", "normals_", "norm_", "n_"})
      if (shared.size() == normal.size() + 1 && shared.starts_with(normal) && shared.back() == axis) return {'n', axis};
  const auto alias = std::ranges::find(kAliases, std::string_view(shared), &Alias::first);
  return alias == kAliases.end() ? shared : std::string(alias->second);
}

}  // namespace palpate
