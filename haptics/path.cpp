#include "haptics/path.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

#include "engine/core/check.hpp"
#include "engine/core/error.hpp"

namespace palpate {
namespace {

constexpr std::string_view kHeader = "t_s,x,y,z";
constexpr std::size_t kColumns = 4;
constexpr std::size_t kLongestLine = 4096;  // a file without line ends must not fill the memory

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

/// Hands out the lines that say something, with their numbers.
class Lines {
 public:
  explicit Lines(const std::filesystem::path& file) : file_(file), in_(file, std::ios::binary) {
    if (!in_) throw FileError(file_, "cannot be opened; does it exist, and may you read it?");
  }

  std::optional<std::string_view> next() {
    while (in_.getline(buffer_.data(), buffer_.size())) {
      ++number_;
      std::string_view line = buffer_.data();
      constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
      if (number_ == 1 && line.starts_with(kByteOrderMark)) line.remove_prefix(kByteOrderMark.size());
      line = trimmed(line);
      if (!line.empty() && line.front() != '#') return line;
    }
    if (in_.bad()) throw FileError(file_, "cannot be read; is it a file?");
    if (!in_.eof()) {
      ++number_;
      fail("the line is too long; is this a path in CSV?");
    }
    return std::nullopt;
  }

  [[noreturn]] void fail(std::string_view what) const {
    throw FileError::atLine(file_, std::max<std::uint64_t>(number_, 1), what);
  }

 private:
  std::filesystem::path file_;
  std::ifstream in_;
  std::array<char, kLongestLine> buffer_{};
  std::uint64_t number_ = 0;
};

bool isHeader(std::string_view line) {
  std::string compact;
  std::copy_if(line.begin(), line.end(), std::back_inserter(compact), [](char c) { return c != ' ' && c != '\t'; });
  return compact == kHeader;
}

double numberFrom(std::string_view field, const Lines& lines) {
  double value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error == std::errc::result_out_of_range) lines.fail(fmt::format("'{}' does not fit a double", field));
  if (error != std::errc() || end != field.data() + field.size())
    lines.fail(fmt::format("'{}' is not a number", field));
  if (!std::isfinite(value)) lines.fail(fmt::format("'{}' is not finite", field));
  return value;
}

PathKey keyFrom(std::string_view line, const Lines& lines) {
  const auto columns = static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1;
  if (columns != kColumns) lines.fail(fmt::format("{} columns; a row has {} ({})", columns, kColumns, kHeader));
  std::array<double, kColumns> values{};
  for (double& value : values) {
    const std::size_t comma = std::min(line.find(','), line.size());
    value = numberFrom(trimmed(line.substr(0, comma)), lines);
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
  Lines lines(file);
  const std::optional<std::string_view> header = lines.next();
  if (!header) lines.fail(fmt::format("the file is empty; it must begin with {}", kHeader));
  if (!isHeader(*header)) lines.fail(fmt::format("the header is missing; the first line must be {}", kHeader));

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
