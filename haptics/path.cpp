#include "haptics/path.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>

#include "engine/core/check.hpp"
#include "haptics/text_lines.hpp"

namespace palpate {
namespace {

constexpr std::string_view kPathHeader = "t_s,x,y,z";
constexpr std::size_t kColumns = 4;

bool isHeader(std::string_view line) {
  std::string compact;
  std::copy_if(line.begin(), line.end(), std::back_inserter(compact), [](char c) { return c != ' ' && c != '\t'; });
  return compact == kPathHeader;
}

PathKey keyFrom(std::string_view line, const TextLines& lines) {
  const auto columns = static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1;
  if (columns != kColumns) lines.fail(fmt::format("{} columns; a row has {} ({})", columns, kColumns, kPathHeader));
  std::array<double, kColumns> values{};
  for (double& value : values) {
    const std::size_t comma = std::min(line.find(','), line.size());
    value = lines.number(trimmed(line.substr(0, comma)));
    line.remove_prefix(std::min(comma + 1, line.size()));
  }
  return {values[0], {values[1], values[2], values[3]}};
}

}  // namespace

Path::Path(std::vector<PathKey> keys) : keys_(std::move(keys)) {
  PALPATE_CHECK(!keys_.empty());
  for (std::size_t i = 1; i < keys_.size(); ++i) PALPATE_CHECK_LT(keys_[i - 1].t_s, keys_[i].t_s);
}

DVec3 Path::at(double t_s) const noexcept {
  const auto after =
      std::upper_bound(keys_.begin(), keys_.end(), t_s, [](double t, const PathKey& key) { return t < key.t_s; });
  if (after == keys_.begin()) return keys_.front().position;
  if (after == keys_.end()) return keys_.back().position;
  const PathKey& from = *(after - 1);
  const double part = (t_s - from.t_s) / (after->t_s - from.t_s);
  return from.position + part * (after->position - from.position);
}

Path readPathCsv(const std::filesystem::path& file) {
  TextLines lines(file);
  const std::optional<std::string_view> header = lines.next();
  if (!header) lines.fail(fmt::format("the file is empty; it must begin with {}", kPathHeader));
  if (!isHeader(*header)) lines.fail(fmt::format("the header is missing; the first line must be {}", kPathHeader));

  std::vector<PathKey> keys;
  while (const std::optional<std::string_view> line = lines.next()) {
    const PathKey key = keyFrom(*line, lines);
    if (key.t_s < 0) lines.fail("t_s is negative; a session begins at 0");
    if (!keys.empty() && key.t_s <= keys.back().t_s)
      lines.fail(fmt::format("t_s must ascend, and {} follows {}", key.t_s, keys.back().t_s));
    keys.push_back(key);
  }
  if (keys.empty()) lines.fail("no row follows the header; a path has at least one point");
  return Path(std::move(keys));
}

}  // namespace palpate
