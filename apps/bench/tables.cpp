#include "apps/bench/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <span>
#include <utility>
#include <vector>

#include "apps/bench/plot_scripts.hpp"
#include "apps/cli/run_program.hpp"
#include "engine/core/error.hpp"
#include "engine/core/system_file.hpp"

namespace palpate {

namespace {

// A temporary folder, deleted with its contents.
class ScratchFolder {
 public:
  ScratchFolder() {
    const std::filesystem::path all = std::filesystem::temp_directory_path();
    std::error_code error;
    for (int number = 0; !error; ++number) {
      path_ = all / fmt::format("palpate-{}-{}", processNumber(), number);
      if (std::filesystem::create_directory(path_, error)) return;  // otherwise the name is taken
    }
    throw Error("{}: cannot create a temporary folder there: {}", all.string(), error.message());
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

std::string pythonWithMatplotlib() {
  for (const std::string& python : pythonNames())
    if (runProgram(python,
                   {"-c", "import importlib.util, sys; sys.exit(not importlib.util.find_spec('matplotlib'))"}) == 0)
      return python;
  throw Error("--plot requires python3 with matplotlib; install python3-matplotlib");
}

const char* textOf(PlotScript script) {
  switch (script) {
    case PlotScript::bench:
      return plot_script::kBench;
    case PlotScript::touch:
      return plot_script::kTouch;
    case PlotScript::edit:
      return plot_script::kEdit;
  }
  return "";
}

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

void plot(PlotScript script, const Json& result, const std::string& file) {
  const ScratchFolder folder;
  const std::filesystem::path json = folder.path() / "result.json", main = folder.path() / "plot.py";
  std::ofstream(json) << result.dump();
  std::ofstream(main) << textOf(script);
  std::ofstream(folder.path() / "plot_page.py") << plot_script::kPage;  // shared by the scripts
  if (runProgram(pythonWithMatplotlib(), {main.string(), json.string(), std::filesystem::absolute(file).string()}) != 0)
    throw Error("{}: cannot draw the plot; see the message above", file);
}

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
