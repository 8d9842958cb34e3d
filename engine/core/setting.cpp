#include "engine/core/setting.hpp"

namespace palpate {

std::string inWords(const Range& range) {
  std::string text;
  if (range.excludesMin)
    text = range.max < Range::kInfinity ? fmt::format("above {:g}, up to {:g}", range.min, range.max)
                                        : fmt::format("above {:g}", range.min);
  else if (range.isBounded())
    text = fmt::format("{:g} to {:g}", range.min, range.max);
  return range.orZero ? fmt::format("0, or {}", text) : text;
}

void requireIn(const Range& range, std::string_view path, double value) {
  if (range.contains(value)) return;
  if (!range.excludesMin) throw ConfigError(path, "{} is not between {} and {}", value, range.min, range.max);
  if (range.max < Range::kInfinity)
    throw ConfigError(path, "is {}, not above {} and at most {}", value, range.min, range.max);
  throw ConfigError(path, "is {}, not above {}", value, range.min);
}

}  // namespace palpate
