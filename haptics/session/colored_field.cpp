#include "haptics/session/colored_field.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "engine/cloud/las_classes.hpp"
#include "engine/cloud/length_text.hpp"
#include "engine/core/counted.hpp"

namespace palpate {

namespace {

constexpr Setting<ColorConfig> kColor[]{
    {"by", &ColorConfig::by, "--color-by,--color",
     "rgb (of the file, else of the material), material (its own, whatever the file has), normal, depth, height (with "
     "a "
     "legend), or a field of the points, as intensity, classification, z or roughness (with a legend; grey: no "
     "number)"},
    {"map", words<&ColorConfig::map, kColorMapChoices>(), "--color-map",
     "colours of numbers: viridis, turbo, grey, red-blue (white in the middle), classes (of LAS), terrain (blue, "
     "green, "
     "yellow), or auto (classes for the field classification, terrain for height and depth, else viridis)"},
    {"range", &ColorConfig::range, "--color-range",
     "LOW,HIGH: numbers at the ends of the colours, or percentiles of the field as 2%,98%; auto: that, and of classes "
     "all"},
};

constexpr double kApart = 0.09;  // of marks, share of the ramp

// Round numbers between the ends, at least `least` apart, with their texts, and the ends.
std::vector<Legend::Mark> marksBetween(double low, double high, double least,
                                       const std::function<std::string(double)>& text) {
  const double extent = high - low;
  if (!(extent > 0)) return {{0.5, text(low)}};
  std::vector<Legend::Mark> marks{{0, text(low)}};
  constexpr double kPieces = 3;
  const double step = std::max(least, roundLength(extent / kPieces));
  for (double n = std::ceil(low / step); step > 0 && n * step < high; ++n) {
    const double share = (n * step - low) / extent;
    if (share > kApart && share < 1 - kApart) marks.push_back({share, text(n * step)});
  }
  marks.push_back({1, text(high)});
  return marks;
}

std::string unitOf(const PointField& field, LengthUnit unit) {
  const std::optional<CloudFields::Field> in = field.inFile();
  if (!field.unit().empty() || !in) return field.unit();
  if (in->source == CloudFields::Field::Source::coordinate) return std::string(nameOf(unit));
  if (in->source != CloudFields::Field::Source::made) return {};
  switch (static_cast<MadeField>(in->index)) {
    case MadeField::height:
      return std::string(nameOf(unit));
    case MadeField::density:
      return "1/mm2";
    case MadeField::roughness:
      return "mm";
    case MadeField::curvature:
      return "1/mm";
    case MadeField::verticality:
      break;
  }
  return {};
}

}  // namespace

ColorMap ColorConfig::mapOf() const {
  return map.value_or(by == kClassification ? ColorMap::classes : source() ? ColorMap::terrain : ColorMap::viridis);
}

std::span<const Setting<ColorConfig>> settingsOf(const ColorConfig*) { return kColor; }

void validate(const ColorConfig& config, const ColorNames& names) {
  if (config.range != "auto") checkRange(names.range, config.range);
  if (config.map == ColorMap::classes && config.source())
    throw UsageError("{}: classes are numbers of a field; name it with {}, as classification", names.map, names.by);
}

Legend legendOf(std::string_view name, LengthUnit unit, double low, double high, ColorMap map) {
  const double resolution = (high - low) / 1000;
  return {.heading = fmt::format("{}, {}", name, nameOf(unit)),
          .map = map,
          .marks = marksBetween(low, high, 0, [&](double length) { return coordinateText(length, resolution); }),
          .entries = {}};
}

ColoredField::ColoredField(const ColorConfig& config, const PointCloud& file, const std::vector<Field>& fields,
                           const FieldOptions& options, LengthUnit unit, const ColorNames& names)
    : field_(names.by, config.by, file, fields, options, namesOf(kColorNames)),
      names_(names),
      unit_(unitOf(field_, unit)) {}

void ColoredField::read(std::span<const PointState> states, const std::vector<Field>& fields, const PointBits& shown) {
  field_.read(states, fields);
  ++version_;
  summarise(shown);
}

std::vector<std::pair<std::uint64_t, float>> ColoredField::follow(std::span<const PointState> changed,
                                                                  const std::vector<Field>& fields) {
  ++version_;
  return field_.follow(changed, fields);
}

void ColoredField::summarise(const PointBits& shown) {
  const std::span<const double> numbers = field_.numbers();
  std::vector<double> seen;
  seen.reserve(numbers.size());
  for (std::size_t i = 0; i < std::min(numbers.size(), shown.size()); ++i)
    if (shown.test(i)) seen.push_back(numbers[i]);
  sorted_ = sortedNumbers(seen);
  statistics_ = statisticsOfSorted(sorted_);
  statistics_.missing = seen.size() - sorted_.size();
  isWhole_ = std::ranges::all_of(sorted_, [](double number) { return number == std::floor(number); });
  extent_ = {0, 1};
  resolution_ = 0;
  histogram_.clear();
  if (!sorted_.empty()) count();
}

void ColoredField::count() {
  constexpr double kParts = 48;
  const double low = percentileOf(sorted_, 1), high = percentileOf(sorted_, 99), beyond = 0.2 * (high - low);
  extent_ = {std::max(low - beyond, sorted_.front()), std::min(high + beyond, sorted_.back())};
  resolution_ = (extent_.second - extent_.first) / 1000;
  double parts = kParts;
  if (isWhole_ && sorted_.back() - sorted_.front() < kParts) {  // one for each number
    parts = sorted_.back() - sorted_.front() + 1;
    extent_ = {sorted_.front() - 0.5, sorted_.back() + 0.5};
  }
  histogram_.resize(static_cast<std::size_t>(parts));
  for (auto at = std::ranges::lower_bound(sorted_, extent_.first); at != sorted_.end() && *at <= extent_.second; ++at) {
    const double width = extent_.second - extent_.first, share = width > 0 ? (*at - extent_.first) / width : 0.5;
    ++histogram_[std::min(static_cast<std::size_t>(share * parts), histogram_.size() - 1)];
  }
}

std::pair<double, double> ColoredField::range(const ColorConfig& config) const {
  const bool isAuto = config.range == "auto";
  const std::string_view text = !isAuto                               ? std::string_view(config.range)
                                : config.mapOf() == ColorMap::classes ? "0%,100%"
                                                                      : "2%,98%";
  return rangeIn(names_.range, text, field_, sorted_);
}

FieldColors ColoredField::colors(const ColorConfig& config) const {
  const auto [low, high] = range(config);
  return {.low = low, .high = high, .version = version_};
}

std::vector<std::array<std::uint8_t, 4>> ColoredField::pointColors(const ColorConfig& config) const {
  const auto [low, high] = range(config);
  const auto map = static_cast<std::uint32_t>(config.mapOf());
  std::vector<std::array<std::uint8_t, 4>> colors;
  colors.reserve(field_.numbers().size());
  for (const float number : field_.numbers()) {
    const Vec3 color = std::isnan(number)
                           ? shared::kNoNumberColor
                           : shared::numberColor(map, number, static_cast<float>(low), static_cast<float>(high));
    const auto byte = [](float part) { return static_cast<std::uint8_t>(std::lround(255 * part)); };
    colors.push_back({byte(color.x), byte(color.y), byte(color.z), 255});
  }
  return colors;
}

Legend ColoredField::legend(const ColorConfig& config) const {
  Legend legend{.heading = heading(), .map = config.mapOf(), .marks = {}, .entries = {}};
  constexpr std::size_t kMaxEntries = 14;
  const double base = static_cast<double>(field_.base());
  if (legend.map != ColorMap::classes) {
    const auto [low, high] = range(config);
    const double resolution = (high - low) / 1000;
    const auto text = [&](double number) { return field_.text(number - base, resolution); };
    // Near a base far from zero round numbers are those of the differences, which doubles hold.
    legend.marks = field_.isWide() && base != 0
                       ? marksBetween(low, high, 1, [&](double number) { return field_.text(number, 1); })
                       : marksBetween(low + base, high + base, isWhole_ ? 1 : 0, text);
  } else {
    for (auto at = sorted_.begin(); at != sorted_.end() && legend.entries.size() < kMaxEntries;) {
      const auto next = std::upper_bound(at, sorted_.end(), std::floor(*at + 0.5) + 0.499999);
      legend.entries.push_back(
          {shared::classColor(static_cast<float>(*at)), lasClassText(std::floor(*at + 0.5) + base)});
      at = next;
      if (legend.entries.size() == kMaxEntries && at != sorted_.end())
        legend.entries.push_back({Vec3(0), "further classes"});
    }
  }
  if (statistics_.missing > 0) legend.entries.push_back({shared::kNoNumberColor, "no number"});
  return legend;
}

std::uint64_t ColoredField::countIn(std::pair<double, double> range) const {
  const auto end = std::ranges::upper_bound(sorted_, range.second);
  const auto begin = std::ranges::lower_bound(sorted_, range.first);
  return begin < end ? static_cast<std::uint64_t>(end - begin) : 0;
}

}  // namespace palpate
