// One description of each reported number: its JSON key, unit, meaning and value. The results of --json and the
// reference page come out of these rows.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/cli/json.hpp"

namespace palpate {

template <class Report>
struct Reported {
  std::string_view key;  ///< "memory.points_bytes": a member of the object "memory"
  std::string_view unit, meaning;
  std::optional<Json> (*value)(const Report& report);  ///< nothing: the key is left out
};

/// The member of an object, or of an object in it: "memory.points_bytes". Missing ones are made.
inline Json& memberAt(Json& json, std::string_view key) {
  const std::size_t dot = key.find('.');
  return dot == key.npos ? json[key] : memberAt(json[key.substr(0, dot)], key.substr(dot + 1));
}

/// Adds all keys of a table to an object, in its order.
template <class Rows, class Report>
void addBy(Json& json, const Rows& rows, const Report& report) {
  for (const Reported<Report>& row : rows)
    if (std::optional<Json> value = row.value(report)) memberAt(json, row.key) = std::move(*value);
}

/// The object with all keys of a table, in its order.
template <class Rows, class Report>
Json jsonBy(const Rows& rows, const Report& report) {
  Json json = Json::object();
  addBy(json, rows, report);
  return json;
}

/// The objects with all keys of a table, one for each report.
template <class Rows, class Reports>
Json arrayBy(const Rows& rows, const Reports& reports) {
  Json all = Json::array();
  for (const auto& report : reports) all.push_back(jsonBy(rows, report));
  return all;
}

/// The object of a part that a report may have; otherwise the key is left out.
template <class Rows, class Part>
std::optional<Json> partBy(const Rows& rows, const std::optional<Part>& part) {
  return part ? std::optional(jsonBy(rows, *part)) : std::nullopt;
}

/// The type to which a member belongs.
template <class Report, class T>
const Report& ownerOf(T Report::*);

/// The value of a row that is a member of the report, or what a member function without arguments returns.
template <auto member>
std::optional<Json> field(decltype(ownerOf(member)) report) {
  return Json(std::invoke(member, report));
}

/// The value, or null.
template <class T>
Json orNull(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

/// A result of --json without its value. `key`: as in "partial.points", or "gaps[].ticks" for objects of a list.
struct ResultFacts {
  std::string command, key, unit, meaning;
};

template <class Rows>
void listResults(std::vector<ResultFacts>& all, std::string_view command, std::string_view before, const Rows& rows) {
  for (const auto& row : rows)
    all.push_back({std::string(command), std::string(before) + std::string(row.key), std::string(row.unit),
                   std::string(row.meaning)});
}

/// A result of a command that writes its JSON itself; a test compares these rows with what it writes.
struct DescribedKey {
  std::string_view key, unit, meaning;
};

/// Each appends the results of its command.
void listInfoResults(std::vector<ResultFacts>& all);
void listBenchResults(std::vector<ResultFacts>& all);  ///< nothing without PALPATE_STUDY
void listReplayResults(std::vector<ResultFacts>& all);

/// The results of all commands that write some with --json, by command.
std::vector<ResultFacts> allResults();

}  // namespace palpate
