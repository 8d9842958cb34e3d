#include "engine/select/point_field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>

#include "engine/core/error.hpp"
#include "engine/core/unknown_name.hpp"
#include "engine/select/field_statistics.hpp"

namespace palpate {

namespace {

using Source = CloudFields::Field::Source;

constexpr double kFarFromZero = 8;  // in extents of the numbers: single precision would lose digits

bool isWideType(ScalarType type) { return type == ScalarType::i64 || type == ScalarType::u64; }

// The whole number from which small differences can be told; 0 where the numbers are not far from it.
template <class T>
Whole baseOf(std::span<const T> values) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  Whole least = 0;
  for (const T value : values) {
    const auto number = static_cast<double>(value);
    if (!std::isfinite(number)) continue;
    if (number < low) least = static_cast<Whole>(std::floor(std::clamp(number, -1e30, 1e30)));
    if constexpr (!std::is_floating_point_v<T>) {
      if (number <= low) least = number < low ? Whole{value} : std::min(least, Whole{value});
    }
    low = std::min(low, number), high = std::max(high, number);
  }
  constexpr double kLarge = 1 << 12;  // beyond classes and colours
  return low <= high && std::max(std::abs(low), std::abs(high)) > kLarge && std::abs(low) > kFarFromZero * (high - low)
             ? least
             : 0;
}

template <class T>
double relativeTo(Whole base, T value) {
  if constexpr (std::is_floating_point_v<T>)
    return static_cast<double>(value) - static_cast<double>(base);
  else
    return static_cast<double>(Whole{value} - base);
}

std::string wholeText(Whole number) {
  std::string digits;
  for (Whole rest = number; rest != 0 || digits.empty(); rest /= 10)
    digits.push_back(static_cast<char>('0' + std::abs(static_cast<int>(rest % 10))));
  if (number < 0) digits.push_back('-');
  std::ranges::reverse(digits);
  return digits;
}

template <class T>
std::optional<T> parsed(std::string_view text) {
  T value{};
  const auto [last, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || last != text.data() + text.size()) return std::nullopt;
  return value;
}

// An end of a range.
struct End {
  std::string text;
  std::optional<double> percent;
};

std::array<End, 2> endsIn(std::string_view setting, std::string_view text) {
  const auto refuse = [&] { return UsageError("{}: '{}' is not LOW,HIGH, as in 0,12.5 or 2%,98%", setting, text); };
  const std::size_t comma = text.find(',');
  if (comma == std::string_view::npos) throw refuse();
  std::array<End, 2> ends;
  std::array<double, 2> numbers{};
  for (std::size_t k = 0; k < 2; ++k) {
    std::string_view one = k == 0 ? text.substr(0, comma) : text.substr(comma + 1);
    while (!one.empty() && one.front() == ' ') one.remove_prefix(1);
    while (!one.empty() && one.back() == ' ') one.remove_suffix(1);
    const bool isPercent = one.ends_with('%');
    if (isPercent) one.remove_suffix(1);
    const auto number = parsed<double>(one);
    if (!number || !std::isfinite(*number) || (isPercent && !(*number >= 0 && *number <= 100))) throw refuse();
    ends[k].text = one;
    if (isPercent) ends[k].percent = number;
    numbers[k] = *number;
  }
  if (ends[0].percent.has_value() == ends[1].percent.has_value() && numbers[0] > numbers[1])
    throw UsageError("{}: '{}' begins above its end; write the lower number first", setting, text);
  return ends;
}

}  // namespace

PointField::PointField(std::string_view setting, std::string_view name, const PointCloud& file,
                       const std::vector<Field>& fields, const FieldOptions& options, std::vector<std::string> others)
    : file_(file), name_(name) {
  CloudFields inFile(file, options);
  const auto found = inFile.find(name);
  const auto of = std::ranges::find(fields, name, [](const Field& each) { return std::string_view(each.values.name); });
  if (!found && of == fields.end()) {
    std::ranges::move(fieldNames(file, fields), std::back_inserter(others));
    throw UsageError("{}: {}", setting, unknownName("field", name, others));
  }
  if (of != fields.end()) isWide_ = isWideType(of->values.type), unit_ = of->unit;
  if (!found) return;
  source_ = inFile.all()[*found];
  isWide_ |= source_->isWhole;
  inFile.compute(*found);
  inFile_.resize(file.size());
  if (source_->isWhole) {
    std::vector<Whole> whole(file.size());
    inFile.read(*found, 0, whole);
    base_ = baseOf(std::span<const Whole>(whole));
    std::ranges::transform(whole, inFile_.begin(), [&](Whole value) { return relativeTo(base_, value); });
  } else {
    inFile.read(*found, 0, inFile_);
    base_ = baseOf(std::span<const double>(inFile_));
    for (double& value : inFile_) value = relativeTo(base_, value);
  }
}

double PointField::numberOf(const PointState& point, const std::vector<Field>& fields) const {
  if (layer_) {
    const Attribute& values = fields[*layer_].values;
    return visitScalar(values.type, [&]<class T>(std::type_identity<T>) {
      if ((point.number + 1) * sizeof(T) > values.data.size()) return relativeTo(base_, T{});
      return relativeTo(base_, loadScalar<T>(values.data, point.number * sizeof(T)));
    });
  }
  const bool isOfFile = point.number < file_.size();
  const auto axis = static_cast<int>(source_->index);
  switch (source_->source) {
    case Source::coordinate:
      if (isOfFile && point.position == file_.positions[point.number]) break;
      return relative(file_.origin[axis] + static_cast<double>(point.position[axis]));
    case Source::normal:
      return relative(static_cast<double>(point.normal[axis]));
    case Source::color:
      return relative(static_cast<double>(unpackedColor(point.color)[source_->index]));
    case Source::attribute:
    case Source::made:
      if (!isOfFile) return point.parent < numbers_.size() ? numbers_[point.parent] : std::nan("");
  }
  return inFile_[point.number];
}

void PointField::put(const PointState& point, const std::vector<Field>& fields) {
  if (point.number >= numbers_.size()) numbers_.resize(point.number + 1, std::nan(""));
  const double number = numberOf(point, fields);
  numbers_[point.number] = std::isfinite(number) ? number : std::nan("");
}

void PointField::read(std::span<const PointState> states, const std::vector<Field>& fields) {
  const auto of = std::ranges::find(fields, name_, [](const Field& each) { return each.values.name; });
  layer_ = of == fields.end() ? std::nullopt : std::optional(static_cast<std::size_t>(of - fields.begin()));
  numbers_.assign(states.size(), std::nan(""));
  if (!layer_ && !source_) return;  // it was undone
  for (const PointState& state : states) put(state, fields);
}

std::vector<std::pair<std::uint64_t, float>> PointField::follow(std::span<const PointState> changed,
                                                                const std::vector<Field>& fields) {
  std::vector<std::pair<std::uint64_t, float>> numbers;
  if (!layer_ && !source_) return numbers;
  numbers.reserve(changed.size());
  for (const PointState& state : changed) {
    put(state, fields);
    numbers.emplace_back(state.number, static_cast<float>(numbers_[state.number]));
  }
  return numbers;
}

std::optional<double> PointField::relative(std::string_view text) const {
  if (isWide_) {
    if (const auto number = parsed<std::int64_t>(text)) return relativeTo(base_, *number);
    if (const auto number = parsed<std::uint64_t>(text)) return relativeTo(base_, *number);
  }
  const auto number = parsed<double>(text);
  return number ? std::optional(relative(*number)) : std::nullopt;
}

std::string PointField::text(double relative, double resolution) const {
  if (isWide_) return wholeText(base_ + static_cast<Whole>(std::round(relative)));
  constexpr double kMaxDecimals = 12;
  const double decimals = resolution > 0 ? std::clamp(std::ceil(-std::log10(resolution)), 0.0, kMaxDecimals) : 3;
  std::string text = fmt::format("{:.{}f}", static_cast<double>(base_) + relative, static_cast<int>(decimals));
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

std::vector<std::string> fieldNames(const PointCloud& file, const std::vector<Field>& fields) {
  std::vector<std::string> names = CloudFields(file).names();
  for (const Field& field : fields)
    if (std::ranges::count(names, field.values.name) == 0) names.insert(names.begin(), field.values.name);
  return names;
}

std::pair<double, double> rangeIn(std::string_view setting, std::string_view text, const PointField& field,
                                  std::span<const double> sorted) {
  const std::array<End, 2> ends = endsIn(setting, text);
  const auto number = [&](const End& end) {
    if (!end.percent) return field.relative(end.text).value_or(0);
    return sorted.empty() ? 0 : percentileOf(sorted, *end.percent);
  };
  const double low = number(ends[0]), high = number(ends[1]);
  if (low > high) throw UsageError("{}: '{}' begins above its end; write the lower number first", setting, text);
  return {low, high};
}

void checkRange(std::string_view setting, std::string_view text) { endsIn(setting, text); }

PointBits pointsInRange(const PointField& field, const PointBits& among, std::pair<double, double> range) {
  const std::span<const double> numbers = field.numbers();
  return PointBits::where(among.size(), 0, [&](std::size_t i) {
    return among.test(i) && i < numbers.size() && numbers[i] >= range.first && numbers[i] <= range.second;
  });
}

}  // namespace palpate
