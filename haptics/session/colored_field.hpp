// Pictures whose points are coloured by their numbers: settings, range of colours, and legend. Independent of Vulkan.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/cloud/length_unit.hpp"
#include "engine/core/setting.hpp"
#include "engine/render/frame_options.hpp"
#include "engine/select/field_statistics.hpp"
#include "engine/select/point_field.hpp"

namespace palpate {

inline constexpr std::array<std::pair<std::string_view, std::optional<ColorMap>>, 7> kColorMapChoices{
    {{"auto", std::nullopt},
     {"viridis", ColorMap::viridis},
     {"turbo", ColorMap::turbo},
     {"grey", ColorMap::grey},
     {"red-blue", ColorMap::redBlue},
     {"classes", ColorMap::classes},
     {"terrain", ColorMap::terrain}}};

/// What the colours of a picture show.
struct ColorConfig {
  std::string by = "rgb";  ///< a name of kColorNames, or a field
  std::optional<ColorMap>
      map;  ///< empty: classes for the field classification, terrain for heights and depths, else viridis
  std::string range = "auto";  ///< "LOW,HIGH" (rangeIn()); auto: 2%,98%, and all numbers of classes

  std::optional<ColorSource> source() const { return valueNamed(kColorNames, by); }  ///< empty: a field
  ColorMap mapOf() const;
  bool operator==(const ColorConfig&) const = default;
};
std::span<const Setting<ColorConfig>> settingsOf(const ColorConfig*);
/// What errors call these settings: options of the command line, or other names.
struct ColorNames {
  std::string_view by = "--color-by", map = "--color-map", range = "--color-range";
};
/// Throws UsageError for a range, or a colour map that does not suit `by`.
void validate(const ColorConfig& config, const ColorNames& names = {});

/// What a legend shows, beside the picture.
struct Legend {
  struct Mark {
    double share = 0;  ///< of the ramp, from its low end
    std::string text;
  };
  struct Entry {
    Vec3 color{0};  ///< sRGB, 0 to 1
    std::string text;
  };
  std::string heading;
  ColorMap map = ColorMap::viridis;
  std::vector<Mark> marks;     ///< ascending
  std::vector<Entry> entries;  ///< in place of the ramp, or below it
};
/// A legend of lengths, with marks at both ends and at round lengths between them.
Legend legendOf(std::string_view name, LengthUnit unit, double low, double high, ColorMap map);

/// A field, the numbers that are shown of it, and their colours. For one thread.
class ColoredField {
 public:
  /// As PointField; `unit`: of the model's lengths.
  ColoredField(const ColorConfig& config, const PointCloud& file, const std::vector<Field>& fields,
               const FieldOptions& options, LengthUnit unit, const ColorNames& names = {});

  const PointField& field() const { return field_; }
  /// Takes all points: PointField::read(). `shown`: those whose numbers count.
  void read(std::span<const PointState> states, const std::vector<Field>& fields, const PointBits& shown);
  /// PointField::follow(); summarise() is due then.
  std::vector<std::pair<std::uint64_t, float>> follow(std::span<const PointState> changed,
                                                      const std::vector<Field>& fields);
  /// Takes the statistics again.
  void summarise(const PointBits& shown);

  /// Ends of the range, relative to the field's base. Throws UsageError.
  std::pair<double, double> range(const ColorConfig& config) const;
  /// For FrameOptions, with what floats() returned last.
  FieldColors colors(const ColorConfig& config) const;
  /// RGBA8 of each point by number, as pictures show it: for surfaces that are made of the points. Throws UsageError.
  std::vector<std::array<std::uint8_t, 4>> pointColors(const ColorConfig& config) const;
  std::vector<float> floats() const { return {field_.numbers().begin(), field_.numbers().end()}; }
  Legend legend(const ColorConfig& config) const;

  const FieldStatistics& statistics() const { return statistics_; }  ///< relative to the field's base
  std::uint64_t missing() const { return statistics_.missing; }
  /// Shown points in a range, its ends included.
  std::uint64_t countIn(std::pair<double, double> range) const;
  /// A number relative to the base, with the digits that tell a thousandth of all numbers apart.
  std::string text(double relative) const { return field_.text(relative, resolution_); }
  /// The mean of the shown points.
  std::string meanText() const { return field_.text(statistics_.mean, resolution_ / 10); }
  bool isWhole() const { return isWhole_; }  ///< all numbers
  /// What a histogram shows: the numbers without few far ones.
  std::pair<double, double> extent() const { return extent_; }
  /// Shown points in equal parts of the extent.
  const std::vector<float>& histogram() const { return histogram_; }
  std::string heading() const { return unit_.empty() ? field_.name() : field_.name() + ", " + unit_; }

 private:
  void count();

  PointField field_;
  ColorNames names_;
  std::string unit_;
  std::vector<double> sorted_;  // of the shown points
  FieldStatistics statistics_;
  std::pair<double, double> extent_{0, 1};
  std::vector<float> histogram_;
  double resolution_ = 0;
  bool isWhole_ = false;
  std::uint64_t version_ = 0;
};

}  // namespace palpate
