// The reference page: everything that a user can name, from the same tables as the program.
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "apps/cli/context.hpp"
#include "apps/cli/results.hpp"
#include "apps/view/key_table.hpp"
#include "apps/view/script.hpp"
#include "apps/view/window_state.hpp"
#include "engine/io/cloud_formats.hpp"
#include "haptics/session/settings.hpp"
#include "haptics/session/simulation.hpp"
#include "haptics/trace.hpp"

namespace palpate {

namespace {

constexpr std::array<std::pair<int, std::string_view>, 5> kExitCodes{
    {{0, "done"},
     {1, "failed; one line on stderr says what, where and what to do"},
     {2, "wrong usage; nothing was done"},
     {130, "ended by Ctrl+C; the results so far are kept"},
     {143, "ended by SIGTERM; likewise"}}};

// Units that a help text may name after a comma, the longer ones first.
constexpr std::string_view kUnits[]{"N s/mm", "N/mm", "mm/s", "mN m", "pixels", "degrees", "MiB",
                                    "Hz",     "mm",   "us",   "ms",   "N",      "s",       "W"};

// "duration of the session, s (default: ...)" has the unit s.
std::string unitIn(const std::string& help) {
  for (std::size_t at = help.find(", "); at != help.npos; at = help.find(", ", at + 1))
    for (const std::string_view unit : kUnits) {
      const std::size_t end = at + 2 + unit.size();
      if (help.compare(at + 2, unit.size(), unit) == 0 &&
          (end == help.size() || std::string_view(",;:( ").find(help[end]) != std::string_view::npos))
        return std::string(unit);
    }
  return {};
}

// The default that a help text states in brackets.
std::string defaultIn(const std::string& help) {
  for (const std::string_view begin : {"(default: ", "(default "}) {
    const std::size_t at = help.find(begin), end = help.find(')', at);
    if (at != help.npos && end != help.npos) return help.substr(at + begin.size(), end - at - begin.size());
  }
  return {};
}

constexpr std::pair<std::string_view, std::string_view> kKinds[]{
    {"FLOAT", "number"}, {"INT", "whole number"}, {"UINT", "whole number"}, {"TEXT", "text"}};

// "FLOAT:0 to 1" is a number, "TEXT:{a,b}" one of these words.
std::string valueOf(const Option& option) {
  const std::string type = option.type();
  if (const std::size_t from = type.find('{'), to = type.rfind('}'); from != type.npos && to != type.npos) {
    std::string words = type.substr(from + 1, to - from - 1);
    for (std::size_t at = 0; (at = words.find(',', at)) != words.npos; at += 2) words.replace(at, 1, ", ");
    return words;
  }
  if (!option.takesValue()) return {};
  if (type.starts_with("TEXT:")) return type.substr(type.find(':') + 1);
  for (const auto& [kind, words] : kKinds)
    if (type == kind || type.starts_with(fmt::format("{}:", kind))) return std::string(words);
  return type;
}

struct OptionRow {
  std::string names, value, unit, usual, bounds, help;
};

OptionRow rowOf(const Option& option) {
  const std::string shown = option.defaultText(), said = defaultIn(option.help());
  return {.names = option.allNames().substr(0, option.allNames().find('{')),
          .value = valueOf(option),
          .unit = !option.takesValue()          ? std::string()
                  : option.facts().unit.empty() ? unitIn(option.help())
                                                : option.facts().unit,
          .usual = option.isRequired() ? "required"
                   : shown.empty()     ? said
                                       : shown,
          .bounds = option.facts().bounds,
          .help = option.help()};
}

bool isHelp(const Option& option) { return option.allNames().find("--help") != std::string::npos; }

// A row of a table: "|" ends a cell.
std::string row(std::initializer_list<std::string> cells) {
  std::string line = "|";
  for (std::string cell : cells) {
    for (std::size_t at = 0; (at = cell.find('|', at)) != cell.npos; at += 2) cell.replace(at, 1, "\\|");
    line += cell.empty() ? " |" : " " + cell + " |";
  }
  return line + "\n";
}

std::string head(std::initializer_list<std::string> cells) {
  std::string line = row(cells) + "|";
  for (std::size_t i = 0; i < cells.size(); ++i) line += "---|";
  return line + "\n";
}

std::string code(const std::string& text) { return text.empty() ? text : "`" + text + "`"; }

void addCommand(std::string& page, const Options& command, const std::string& name) {
  const std::string what = command.description();
  page += fmt::format("\n### `{}`\n\n{}{}\n", name, what, what.ends_with('.') ? "" : ".");
  std::string heading;
  bool isOpen = false;
  for (const Option& option : command.all()) {
    if (isHelp(option) || (option.heading().empty() && !option.isRequired())) continue;
    if (!isOpen) page += "\n" + head({"option", "value", "unit", "default", "bounds", "meaning"});
    isOpen = true;
    const OptionRow each = rowOf(option);
    page += row({code(each.names), each.value, each.unit, each.usual, each.bounds, each.help});
  }
  for (const auto& subcommand : command.subcommands()) addCommand(page, *subcommand, name + " " + subcommand->name());
}

std::string valuesOf(const SettingFacts& setting) {
  return setting.words.empty() ? setting.type : fmt::format("{}", fmt::join(setting.words, ", "));
}

void addSettingRows(std::string& page) {
  page += head({"key", "value", "unit", "default", "bounds", "option", "since", "meaning"});
  for (const SettingFacts& setting : allSettings())
    if (!setting.path.starts_with("matter."))
      page += row({code(setting.path), valuesOf(setting), setting.unit, setting.usual, inWords(setting.range),
                   code(setting.flag), std::to_string(setting.since), setting.help});
}

void addSceneRows(std::string& page) {
  page += head({"key", "value", "unit", "default", "bounds", "applies to", "meaning"});
  for (const SceneSettingFacts& scene : sceneSettingFacts())
    page += row({code(scene.path.substr(scene.path.find('.') + 1)), valuesOf(scene), scene.unit,
                 scene.required ? "required" : scene.usual, inWords(scene.range), scene.of, scene.help});
}

std::string resultRow(const ResultFacts& result) { return row({code(result.key), result.unit, result.meaning}); }

void addResultRows(std::string& page) {
  std::string command;
  for (const ResultFacts& result : allResults()) {
    if (result.command != command)
      page += fmt::format("\n### `palpate {} --json`\n\n", result.command) + head({"key", "unit", "meaning"});
    command = result.command;
    page += resultRow(result);
  }
}

/// As Markdown, for apps/REFERENCE.md.
std::string referencePage(const Options& program) {
  std::string page =
      "# Reference\n\nAll names that a user can rely on. `palpate reference > apps/REFERENCE.md` makes this page; a "
      "test "
      "compares it with the\nprogram.\n\n## Exit codes\n\n" +
      head({"code", "meaning"});
  for (const auto& [number, meaning] : kExitCodes) page += row({std::to_string(number), std::string(meaning)});
  page += "\n## Commands\n\nThe options of `palpate` belong to all commands.\n";
  addCommand(page, program, "palpate");
  page +=
      "\n## Settings of a session\n\nThe keys of the configuration that a session log contains (version 1). Each "
      "section may be left out.\n\n";
  addSettingRows(page);
  page += "\n## Scenes of matter\n\nThe keys of SCENE.json, and of `matter` in a configuration.\n\n";
  addSceneRows(page);
  page += "\n## Results\n\nTimes of steps are objects with `p50`, `p99`, `p999` and `max`.\n";
  addResultRows(page);
  page += "\n## Columns of a trace\n\n" + head({"column", "unit", "meaning"});
  for (const TraceColumn& column : traceColumns())
    page += row({code(std::string(column.name)), std::string(column.unit), std::string(column.meaning)});
  page += "\n## Events of a window script\n\nOne per line: `TIME_S EVENT`; `#` begins a comment.\n\n" +
          head({"event", "effect"});
  for (const ScriptEvent& event : scriptEvents())
    page += row(
        {code(event.arguments.empty() ? std::string(event.name) : fmt::format("{} {}", event.name, event.arguments)),
         std::string(event.effect)});
  page +=
      "\n## State of the window\n\nThe keys that the event `state` writes; those from `mm_per_unit` on are of an open "
      "model.\n\n" +
      head({"key", "unit", "meaning"});
  std::vector<ResultFacts> state;
  listWindowResults(state);
  for (const ResultFacts& result : state) page += resultRow(result);
  page += "\n## Keys of the window\n\n" + head({"key", "tool", "effect"});
  for (const KeyRow& each : keyRows()) {
    std::string tools;
    for (const auto& [name, tool] : kWindowTools)
      if (each.appliesTo(tool)) tools += (tools.empty() ? "" : ", ") + std::string(name);
    page += row({each.keys, each.tools.size() == kWindowTools.size() ? "all" : tools, each.effect});
  }
  const CloudFormats& formats = cloudFormats();
  page += fmt::format("\n## Files\n\nRead: {}.\n\nWritten: {}.\n\nMeshes are written as {}.\n", formats.endingsRead(),
                      formats.endingsWritten(), formats.endingsWritten(Written::mesh));
  return page;
}

namespace {

void addOptions(Json& all, const Options& command, const std::string& name) {
  for (const Option& option : command.all()) {
    if (isHelp(option)) continue;
    const OptionRow each = rowOf(option);
    all.push_back({{"command", name},
                   {"names", each.names},
                   {"value", each.value},
                   {"unit", each.unit},
                   {"default", each.usual},
                   {"bounds", each.bounds},
                   {"meaning", each.help}});
  }
  for (const auto& subcommand : command.subcommands()) addOptions(all, *subcommand, name + " " + subcommand->name());
}

}  // namespace

/// Options, settings and results as JSON.
Json referenceJson(const Options& program) {
  Json json{{"options", Json::array()}, {"settings", Json::array()}, {"results", Json::array()}};
  addOptions(json["options"], program, "palpate");
  for (const SettingFacts& setting : allSettings())
    json["settings"].push_back({{"key", setting.path},
                                {"value", setting.type},
                                {"words", setting.words},
                                {"unit", setting.unit},
                                {"default", Json::parse(setting.usual)},
                                {"bounds", inWords(setting.range)},
                                {"option", setting.flag},
                                {"since", setting.since},
                                {"meaning", setting.help}});
  std::vector<ResultFacts> results = allResults();
  listWindowResults(results);
  for (const ResultFacts& result : results)
    json["results"].push_back(
        {{"command", result.command}, {"key", result.key}, {"unit", result.unit}, {"meaning", result.meaning}});
  return json;
}

}  // namespace

void addReference(Options& app, Context& context, Command& command) {
  Options& sub = app.addSubcommand("reference",
                                   "print all options, settings, results and file columns, as Markdown or with --json");
  sub.whenNamed([&] {
    command = [&app, &context] {
      fmt::print(context.tables(), "{}", referencePage(app));
      context.writeJson(referenceJson(app));
    };
  });
}

}  // namespace palpate
