// Tables of choices for users: arrays of pairs of a name and the value that it stands for.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// All names of a table, in its order, after the names in `before`.
inline std::vector<std::string> namesOf(const auto& table, std::vector<std::string> before = {}) {
  for (const auto& [name, value] : table) before.emplace_back(name);
  return before;
}

/// The value of a name; empty if the table does not contain it.
template <class Table>
auto valueNamed(const Table& table, std::string_view wanted) {
  std::optional<typename Table::value_type::second_type> found;
  for (const auto& [name, value] : table)
    if (name == wanted) found = value;
  return found;
}

/// The name of a value; empty if the table does not contain it.
std::string_view nameOf(const auto& table, const auto& wanted) {
  for (const auto& [name, value] : table)
    if (value == wanted) return name;
  return {};
}

}  // namespace palpate
