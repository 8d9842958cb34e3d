#include "apps/cli/completion.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "apps/cli/complaint.hpp"

namespace palpate {

namespace {

bool isOption(const std::string& word) { return word.size() > 1 && word.starts_with("-"); }

// The choices of an option, which stand between braces in the help: "TEXT:{push,carve}".
std::vector<std::string> choicesOf(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t from = type.find('{'), to = type.find('}');
  std::vector<std::string> choices;
  if (from == type.npos || to == type.npos) return choices;
  for (std::size_t at = from + 1; at < to;) {
    const std::size_t end = std::min(type.find(',', at), to);
    choices.push_back(type.substr(at, end - at));
    at = end + 1;
  }
  return choices;
}

// Position of the incomplete word in the command line.
struct Place {
  std::vector<const CLI::App*> commands;  // the innermost last; each accepts the options of those above
  const CLI::Option* option = nullptr;    // whose value the word is, or may be
  std::size_t positionals = 0;            // number of those before it

  const CLI::App& command() const { return *commands.back(); }

  const CLI::Option* find(const std::string& name) const {
    for (const CLI::App* app : commands)
      if (const CLI::Option* found = app->get_option_no_throw(name)) return found;
    return nullptr;
  }

  void pass(const std::string& word) {
    if (isOption(word)) {
      const bool hasValue = word.find('=') != word.npos;
      option = hasValue ? nullptr : find(word);
      if (option && option->get_items_expected_max() == 0) option = nullptr;
      return;
    }
    if (option) {
      if (option->get_items_expected_max() == 1) option = nullptr;
      return;
    }
    if (const CLI::App* next = subcommandOf(command(), word))
      commands.push_back(next);
    else
      ++positionals;
  }

  // The next positional option; null if there is none left.
  const CLI::Option* positional() const {
    std::size_t place = 0;
    for (const CLI::Option* candidate : command().get_options())
      if (candidate->get_positional() && place++ == positionals) return candidate;
    return nullptr;
  }
};

// Names of the options that help shows.
std::vector<std::string> optionNames(const Place& place) {
  std::vector<std::string> names;
  for (const CLI::App* app : place.commands)
    for (const CLI::Option* option : app->get_options())
      if (!option->get_group().empty())
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

std::vector<std::string> subcommandNames(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::App* app : command.get_subcommands({}))
    if (!app->get_group().empty()) names.push_back(app->get_name());
  return names;
}

std::vector<std::string> beginningWith(const std::string& begin, std::vector<std::string> words) {
  std::erase_if(words, [&](const std::string& word) { return !word.starts_with(begin); });
  std::ranges::sort(words);
  words.erase(std::unique(words.begin(), words.end()), words.end());
  return words;
}

// "--name", "=", "value" as one word.
std::vector<std::string> joined(const std::vector<std::string>& words) {
  std::vector<std::string> whole;
  bool joins = false;
  for (const std::string& word : words) {
    const bool isSign = word == "=" && !whole.empty() && isOption(whole.back());
    if (joins || isSign)
      whole.back() += word;
    else
      whole.push_back(word);
    joins = isSign;
  }
  return whole;
}

}  // namespace

Completions completionsOf(const CLI::App& app, const std::vector<std::string>& words) {
  std::vector<std::string> whole = joined(words);
  const bool wasSplit = whole.size() < words.size() && whole.back() != words.back();
  const std::string current = whole.empty() ? std::string() : whole.back();
  if (!whole.empty()) whole.pop_back();
  Place place{.commands = {&app}};
  for (const std::string& word : whole) place.pass(word);

  if (const std::size_t sign = current.find('='); isOption(current) && sign != current.npos) {
    const CLI::Option* option = place.find(current.substr(0, sign));
    std::vector<std::string> values =
        beginningWith(current.substr(sign + 1), option ? choicesOf(*option) : std::vector<std::string>());
    const bool files = values.empty();
    if (!wasSplit)
      for (std::string& value : values) value.insert(0, current.substr(0, sign + 1));
    return {.words = std::move(values), .files = files};
  }
  if (isOption(current)) return {.words = beginningWith(current, optionNames(place)), .files = false};
  if (place.option) {
    const std::vector<std::string> choices = choicesOf(*place.option);
    return {.words = beginningWith(current, choices), .files = choices.empty()};
  }
  std::vector<std::string> found = subcommandNames(place.command());
  const CLI::Option* positional = place.positional();
  if (positional) std::ranges::move(choicesOf(*positional), std::back_inserter(found));
  const bool files = place.commands.size() == 1 ? place.positionals == 0 : positional && choicesOf(*positional).empty();
  return {.words = beginningWith(current, std::move(found)), .files = files};
}

}  // namespace palpate
