#include "apps/cli/complaint.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "engine/core/error.hpp"
#include "engine/core/unknown_name.hpp"

namespace palpate {

namespace {

// "--name" of each option that help shows.
void addOptionNames(const CLI::App& app, std::vector<std::string>& names) {
  for (const CLI::Option* option : app.get_options())
    if (!option->get_group().empty())
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
}

std::vector<std::string> namesOf(const std::vector<const CLI::App*>& apps) {
  std::vector<std::string> names(apps.size());
  std::ranges::transform(apps, names.begin(), [](const CLI::App* app) { return app->get_name(); });
  return names;
}

// The innermost command on the command line, and the words that lead to it.
struct Named {
  const CLI::App* command;
  std::string words;
};

Named namedIn(const CLI::App& app) {
  Named named{.command = &app, .words = "palpate"};
  while (!named.command->get_subcommands().empty()) {
    named.command = named.command->get_subcommands().back();
    named.words += " " + named.command->get_name();
  }
  return named;
}

std::string noSubcommand(const CLI::App& command, const std::string& word) {
  return unknownWord("subcommand", word, namesOf(command.get_subcommands({})));
}

// Describes an unexpected word.
std::string aboutWord(const CLI::App& app, const CLI::App& command, const std::string& word) {
  if (word.starts_with("-")) {
    const std::string name = word.substr(0, word.find('='));
    std::vector<std::string> names;
    addOptionNames(command, names);
    addOptionNames(app, names);
    if (std::ranges::find(names, name) != names.end())
      return fmt::format("{} follows --, and what follows that are names, not options; put -- behind the options",
                         name);
    return unknownWord("option", name, names);
  }
  if (command.get_subcommands({}).empty()) return fmt::format("'{}' is one word too many", word);
  return noSubcommand(command, word);
}

// Describes an option with too many values. Empty if there is none.
std::string aboutValues(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options()) {
    const auto most = static_cast<std::size_t>(option->get_items_expected_max());
    if (most > 0 && option->count() > most)
      return fmt::format("{} is given {} times; give it once", option->get_name(), option->count());
  }
  return {};
}

std::string aboutError(const Named& named, const CLI::App& app, const CLI::Error& error) {
  if (error.get_name() == "ArgumentMismatch") {
    for (const CLI::App* command : {named.command, &app})
      if (const std::string about = aboutValues(*command); !about.empty()) return about;
    const std::string text = error.what();
    return fmt::format("{} needs a value", text.substr(0, text.find(':')));
  }
  if (named.command->get_subcommands({}).empty() || named.command->remaining_size() > 0) return error.what();
  return fmt::format("a subcommand is required: {}", fmt::join(namesOf(named.command->get_subcommands({})), ", "));
}

}  // namespace

std::string firstUnexpected(const CLI::App& app) {
  const std::vector<std::string> unexpected = app.remaining(true);
  return unexpected.empty() ? std::string() : unexpected.front();
}

const CLI::App* subcommandOf(const CLI::App& app, const std::string& name) {
  for (const CLI::App* candidate : app.get_subcommands({}))
    if (candidate->get_name() == name) return candidate;
  return nullptr;
}

std::string complaint(const CLI::App& app, const CLI::Error& error) {
  const Named named = namedIn(app);
  const std::string word = firstUnexpected(app);
  const std::string about = word.empty() ? aboutError(named, app, error) : aboutWord(app, *named.command, word);
  return fmt::format("{} {} --help", about.ends_with("?") ? about + " See" : about + "; see", named.words);
}

std::vector<std::string> helpOf(const CLI::App& app, std::vector<std::string> names) {
  const CLI::App* command = &app;
  for (const std::string& name : names) {
    const CLI::App* found = subcommandOf(*command, name);
    if (!found) throw UsageError("{}", noSubcommand(*command, name));
    command = found;
  }
  names.emplace_back("--help");
  return names;
}

}  // namespace palpate
