#include "apps/cli/setting_options.hpp"

#include "apps/cli/parse_list.hpp"

namespace palpate {

std::string listText(const DVec3& vector) { return fmt::format("{:g},{:g},{:g}", vector.x, vector.y, vector.z); }

std::string listText(const std::array<std::uint8_t, 3>& color) {
  return fmt::format("{},{},{}", color[0], color[1], color[2]);
}

void readList(std::string_view option, const std::string& text, DVec3& vector) {
  const auto [x, y, z] = parseList<double, 3>(text, ',', std::string(option), "X,Y,Z");
  vector = {x, y, z};
}

void readList(std::string_view option, const std::string& text, std::array<std::uint8_t, 3>& color) {
  color = parseList<std::uint8_t, 3>(text, ',', std::string(option), "R,G,B from 0 to 255");
}

}  // namespace palpate
