// One description of each reported number: its JSON key, unit, meaning and value. The results of --json and the
// reference page come out of these rows.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/cli/json.hpp"

namespace palpate {

template <class Report>
struct Reported {
  std::string_view key, unit, meaning;
  std::optional<Json> (*value)(const Report& report);  ///< nothing: the key is left out
};

/// The object with all keys of a table, in its order.
template <class Rows, class Report>
Json jsonBy(const Rows& rows, const Report& report) {
  Json json = Json::object();
  for (const Reported<Report>& row : rows)
    if (std::optional<Json> value = row.value(report)) json[row.key] = std::move(*value);
  return json;
}

/// The value, or null.
template <class T>
Json orNull(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

/// A result of --json without its value. `key`: as in "near.points", or "gaps[].ticks" for objects of a list.
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

void listReplayResults(std::vector<ResultFacts>& all);

/// The results of all commands, by command.
std::vector<ResultFacts> allResults();

}  // namespace palpate
