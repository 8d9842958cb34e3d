#include "apps/bench/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

namespace palpate {

namespace {

constexpr std::size_t kLine = 160;  // characters

using Cells = std::vector<std::pair<std::string, std::string>>;  // of one column, by key

bool isList(const Json& json) { return json.isArray() && json.size() > 0 && json.begin()->isObject(); }

bool has(const Json& json, std::string_view key) {
  return std::ranges::any_of(json.items(), [&](const auto& item) { return item.first == key; });
}

bool isSummary(const Json& json) { return json.isObject() && has(json, "p50") && has(json, "p999"); }

// About four digits.
std::string brief(double value) {
  const double size = std::abs(value);
  return size >= 1e3 && size < 1e15 ? fmt::format("{:.0f}", value) : fmt::format("{:.4g}", value);
}

std::string textOf(const Json& value) {
  if (value.is_null()) return "–";
  if (isSummary(value)) return textOf(value["p50"]) + " / " + textOf(value["p999"]);
  if (value.isReal()) return brief(value.get<double>());
  if (value.isText()) return value.get<std::string>();
  if (!value.isArray()) return value.dump();
  constexpr std::size_t kMaxShown = 4;
  if (value.size() > kMaxShown) return fmt::format("{} values", value.size());
  std::string all;
  for (const Json& each : value) all += (all.empty() ? "" : ", ") + textOf(each);
  return all;
}

void addCells(Cells& cells, const std::string& before, const Json& object) {
  for (const auto& [name, value] : object.items()) {
    const std::string key = before + name;
    if (isList(value))
      for (std::size_t i = 0; i < value.size(); ++i) addCells(cells, fmt::format("{}[{}].", key, i), value.at(i));
    else if (value.isObject() && !isSummary(value))
      addCells(cells, key + ".", value);
    else
      cells.emplace_back(key, textOf(value));
  }
}

// Of UTF-8.
std::size_t lengthOf(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return (c & 0xc0) != 0x80; }));
}

std::string padded(const std::string& text, std::size_t width, bool left) {
  const std::string blanks(width - std::min(width, lengthOf(text)), ' ');
  return left ? text + blanks : blanks + text;
}

std::string cellOf(const Cells& cells, const std::string& key) {
  const auto found = std::ranges::find(cells, key, [](const auto& cell) { return cell.first; });
  return found == cells.end() ? "" : found->second;
}

void printColumns(std::FILE* out, const std::vector<std::string>& keys, std::span<const Cells> columns,
                  std::size_t keyWidth, std::span<const std::size_t> widths) {
  for (const std::string& key : keys) {
    std::string line = padded(key, keyWidth, true);
    for (std::size_t i = 0; i < columns.size(); ++i) line += "  " + padded(cellOf(columns[i], key), widths[i], false);
    fmt::print(out, "{}\n", line);
  }
}

void printTable(std::FILE* out, const std::string& title, const std::vector<Cells>& columns) {
  std::vector<std::string> keys;  // of all columns
  std::size_t keyWidth = 0;
  std::vector<std::size_t> widths;
  for (const Cells& cells : columns) {
    std::size_t width = 0;
    for (const auto& [key, text] : cells) {
      if (std::ranges::find(keys, key) == keys.end()) keys.push_back(key);
      keyWidth = std::max(keyWidth, lengthOf(key));
      width = std::max(width, lengthOf(text));
    }
    widths.push_back(width);
  }
  for (std::size_t first = 0; first < columns.size();) {
    std::size_t end = first, line = keyWidth;
    while (end < columns.size() && (end == first || line + 2 + widths[end] <= kLine)) line += 2 + widths[end++];
    fmt::print(out, "\n{} (of times: p50 / p99.9)\n", title);
    printColumns(out, keys, std::span(columns).subspan(first, end - first), keyWidth,
                 std::span(widths).subspan(first, end - first));
    first = end;
  }
}

}  // namespace

void printTables(std::FILE* out, const std::string& title, const Json& result) {
  if (isList(result)) {
    std::vector<Cells> columns;
    for (const Json& each : result) addCells(columns.emplace_back(), "", each);
    return printTable(out, title, columns);
  }
  if (!result.isObject()) return;
  Json rest = Json::object();
  for (const auto& [name, value] : result.items())
    if (isList(value))
      printTables(out, fmt::format("{}, {}", title, name), value);
    else if (!value.isArray() || value.size() > 0)
      rest[name] = value;
  Cells cells;
  addCells(cells, "", rest);
  if (!cells.empty()) printTable(out, title, {cells});
}

}  // namespace palpate
