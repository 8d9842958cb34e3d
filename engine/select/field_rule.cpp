#include "engine/select/field_rule.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <variant>

#include "engine/core/characters.hpp"
#include "engine/core/parallel.hpp"
#include "engine/core/point_state.hpp"
#include "engine/select/expression.hpp"
#include "engine/select/move_points.hpp"

namespace palpate {

namespace {

using Source = CloudFields::Field::Source;

struct Target {
  std::optional<ScalarType> type;
  std::string name;
  std::size_t valueAt;  // where the number begins in the text
};

constexpr std::string_view kForm =
    "a rule has the form [TYPE] NAME = NUMBER [if CONDITION], as in "
    "classification = 6 if z > 3";

Target targetOf(std::string_view name, std::string_view rule) {
  std::vector<std::string> words;
  std::size_t at = 0;
  while (at < rule.size() && rule[at] != '=') {
    if (rule[at] == ' ') {
      ++at;
    } else if (rule[at] == '"' || rule[at] == '\'') {
      const std::size_t end = std::min(rule.find(rule[at], at + 1), rule.size());
      words.emplace_back(rule.substr(at + 1, end - at - 1));
      at = std::min(end + 1, rule.size());
    } else {
      const std::size_t end = std::min(rule.find_first_of(" =\"'", at), rule.size());
      words.emplace_back(rule.substr(at, end - at));
      at = end;
    }
  }
  if (at == rule.size() || rule.substr(at).starts_with("==") || words.empty() || words.back().empty())
    throw ExpressionError(name, "column {}: {}", charactersOf(rule.substr(0, at)).size() + 1, kForm);
  Target target{.type = {}, .name = words.back(), .valueAt = at + 1};
  if (words.size() == 1) return target;
  target.type = scalarTypeFromPly(words.front());
  if (words.size() > 2 || !target.type)
    throw ExpressionError(name, "column 1: '{}' is not a type (int8 to int64, uint8 to uint64, float32, float64); {}",
                          words.front(), kForm);
  return target;
}

/// The values of all points.
using Values = std::variant<std::vector<double>, std::vector<Whole>>;

Values evaluated(const Expression& expression, const CloudFields& fields) {
  if (expression.kind == Expression::Kind::whole) return wholesOf(expression, fields);
  return valuesOf(expression, fields);
}

template <class T>
std::string textOf(T value) {
  if constexpr (std::is_integral_v<T> && !std::is_same_v<T, Whole>) return fmt::format("{}", value);
  const auto number = static_cast<double>(value);
  return std::isnan(number) ? "nan" : fmt::format("{}", number);
}

/// The value as a T; throws Error if a T does not hold it.
template <class T, class From>
T converted(From value, std::string_view name, std::string_view field, std::uint64_t point) {
  if constexpr (std::is_floating_point_v<T>) {
    return static_cast<T>(value);
  } else {
    using Limits = std::numeric_limits<T>;
    bool fits = false;
    if constexpr (std::is_same_v<From, Whole>) {
      fits = value >= Whole{Limits::min()} && value <= Whole{Limits::max()};
    } else {
      value = std::nearbyint(value);
      // The largest 64-bit numbers are not doubles; the number after them is.
      fits = value >= static_cast<double>(Limits::min()) && value < std::ldexp(1.0, Limits::digits);
    }
    if (!fits)
      throw ConfigError(name, "{} = {} of point {} is not a whole number from {} to {}", field, textOf(value), point,
                        textOf(Limits::min()), textOf(Limits::max()));
    return static_cast<T>(value);
  }
}

/// Calls set(point, value) for the points of a set, after all values were converted without an error.
template <class T>
void assign(const Values& values, const PointSet& which, std::string_view name, std::string_view field, auto&& set) {
  std::visit(
      [&](const auto& all) {
        which.forEach([&](std::uint64_t point) { converted<T>(all[point], name, field, point); });
        which.forEach([&](std::uint64_t point) { set(point, converted<T>(all[point], name, field, point)); });
      },
      values);
}

void setAttribute(Attribute& attribute, const Values& values, const PointSet& which, std::string_view name) {
  visitScalar(attribute.type, [&]<class T>(std::type_identity<T>) {
    assign<T>(values, which, name, attribute.name, [&](std::uint64_t point, T value) {
      std::memcpy(attribute.data.data() + point * sizeof(T), &value, sizeof(T));
    });
  });
}

Attribute newAttribute(const std::string& name, ScalarType type, std::size_t points) {
  Attribute made{name, type, {}};
  visitScalar(type, [&]<class T>(std::type_identity<T>) {
    const std::vector<T> none(points, std::is_floating_point_v<T> ? std::numeric_limits<T>::quiet_NaN() : T{});
    made.data.resize(points * sizeof(T));
    if (points > 0) std::memcpy(made.data.data(), none.data(), made.data.size());
  });
  return made;
}

void setColor(PointCloud& cloud, std::size_t channel, const Values& values, const PointSet& which,
              std::string_view name, std::string_view field) {
  auto colors = cloud.colors;
  if (colors.empty()) colors.assign(cloud.size(), kUnpainted);
  assign<std::uint8_t>(values, which, name, field,
                       [&](std::uint64_t point, std::uint8_t value) { colors[point][channel] = value; });
  cloud.colors = std::move(colors);
}

void setCoordinate(PointCloud& cloud, int axis, const Values& values, const PointSet& which, std::string_view name,
                   std::string_view field) {
  std::vector<DVec3> coordinates(cloud.size());
  for (std::size_t i = 0; i < coordinates.size(); ++i) coordinates[i] = cloud.fileCoordinates(i);
  assign<double>(values, which, name, field, [&](std::uint64_t point, double value) {
    if (!std::isfinite(value)) throw ConfigError(name, "{} = {} of point {} is not a coordinate", field, value, point);
    DVec3& moved = coordinates[point];
    moved[axis] = value;
    if (const auto& grid = cloud.storedAs.grid) {  // a sum of decimals is again a position of the file's grid
      constexpr double kRounding = 1e-6;           // steps
      const double on = grid->at(grid->nearest(moved))[axis];
      if (std::abs(on - value) <= kRounding * std::abs(grid->step[axis])) moved[axis] = on;
    }
  });
  movePoints(cloud, coordinates);
}

}  // namespace

bool movesPoints(std::string_view name, std::string_view rule) {
  const std::string field = targetOf(name, rule).name;
  return field == "x" || field == "y" || field == "z";
}

RuleEffect applyRule(std::string_view name, std::string_view rule, PointCloud& cloud, const FieldOptions& options) {
  const Target target = targetOf(name, rule);
  CloudFields fields(cloud, options);
  const ParsedExpression number = parseExpression(name, rule, target.valueAt, false, fields);
  PointSet which = PointSet::range(0, cloud.size());
  if (const std::size_t after = number.end; after < rule.size())  // the word "if"
    which = pointsWhere(parseExpression(name, rule, after + 2, true, fields).expression, fields);
  const Values values = evaluated(number.expression, fields);
  static constexpr std::array<std::string_view, 9> kOwn{"x", "y", "z", "red", "green", "blue", "nx", "ny", "nz"};
  const std::size_t own = static_cast<std::size_t>(std::ranges::find(kOwn, target.name) - kOwn.begin());
  if (own < kOwn.size() && target.type) throw ConfigError(name, "{} has a type of its own; leave it out", target.name);
  if (own < 3) {
    setCoordinate(cloud, static_cast<int>(own), values, which, name, target.name);
  } else if (own < 6) {
    setColor(cloud, own - 3, values, which, name, target.name);
  } else if (own < kOwn.size()) {
    throw ConfigError(name, "{} cannot be set; normals are estimated, oriented or flipped (--normals)", target.name);
  } else if (const auto found = std::ranges::find(cloud.extra, target.name, &Attribute::name);
             found != cloud.extra.end()) {
    if (target.type && *target.type != found->type)
      throw ConfigError(name, "{} is of the type {} in the file; leave the type out, or name another field",
                        target.name, plyName(found->type));
    setAttribute(*found, values, which, name);
  } else {
    const ScalarType usual = number.expression.kind == Expression::Kind::whole ? ScalarType::i64 : ScalarType::f64;
    Attribute made = newAttribute(target.name, target.type.value_or(usual), cloud.size());
    setAttribute(made, values, which, name);
    cloud.extra.push_back(std::move(made));
  }
  RuleEffect effect{.set = which.count()};
  if (const auto* numbers = std::get_if<std::vector<double>>(&values))
    which.forEach([&](std::uint64_t point) { effect.notFinite += std::isfinite((*numbers)[point]) ? 0 : 1; });
  return effect;
}

}  // namespace palpate
