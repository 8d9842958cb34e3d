#include "apps/cli/completion.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>

#include "apps/cli/complaint.hpp"
#include "engine/io/cloud_formats.hpp"

namespace palpate {

namespace {

bool isOption(const std::string& word) { return word.size() > 1 && word.starts_with("-"); }

// The endings of the files that each kind of value in the help may name; those of clouds and meshes are added below.
constexpr std::pair<std::string_view, std::string_view> kFileTypes[]{
    {"FILE", ""},         {"FILE...", ""},    {"FILE|-", ""},           {"SESSION", ""},
    {"LOG", ""},          {"SCENE", ".json"}, {"FILE.csv", ".csv"},     {"FILE.json", ".json"},
    {"FILE.pfm", ".pfm"}, {"FOLDER", "/"},    {"IMG.png", ".png .jpg"}, {"DEVICE|ros", ""}};

// The endings in a list such as ".ply, .xyz, a COLMAP folder", or in ".png .jpg".
std::vector<std::string> endingsIn(const std::string& list) {
  std::vector<std::string> endings;
  for (std::size_t at = 0; at < list.size();) {
    const std::size_t end = std::min(list.find_first_of(", ", at), list.size());
    const std::string word = list.substr(at, end - at);
    if (word.starts_with(".") || word == "/") endings.push_back(word);
    at = end + 1;
  }
  return endings;
}

// The files that a value of an option may name: none, those with some endings, or any.
Completions filesOf(const CLI::Option& option) {
  const std::string type = option.get_type_name(), kind = type.substr(0, type.find_first_of(":["));
  const CloudFormats& formats = cloudFormats();
  if (kind == "MODEL" || kind == "IN" || kind == "FILE...")
    return {.files = true, .endings = endingsIn(formats.endingsRead() + ", .json")};
  if (kind == "OUT.ply" || kind == "OUT") return {.files = true, .endings = endingsIn(formats.endingsWritten())};
  if (kind == "MESH.ply") return {.files = true, .endings = endingsIn(formats.endingsWritten(Written::mesh))};
  for (const auto& [name, endings] : kFileTypes)
    if (kind == name) return {.files = true, .endings = endingsIn(std::string(endings))};
  return {};
}

// The choices of an option: those that the program gives it, or those between braces in the help: "TEXT:{push,carve}".
std::vector<std::string> choicesOf(const CLI::Option& option, const OptionFacts* facts) {
  if (facts && !facts->offers.empty()) return facts->offers;
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
      if (option->get_items_expected_max() == 1 || !option->get_allow_extra_args()) option = nullptr;
      return;
    }
    // A command that takes several subcommands may take more after the first, as in "bench build sort".
    for (std::size_t depth = commands.size(); depth > (commands.size() > 1 ? 1 : 0); --depth)
      if (const CLI::App* next = subcommandOf(*commands[depth - 1], word)) {
        commands.resize(depth);
        return commands.push_back(next);
      }
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

// Names of the subcommands that may come next.
std::vector<std::string> subcommandNames(const Place& place) {
  std::vector<std::string> names;
  for (std::size_t depth = place.commands.size() > 1 ? 1 : 0; depth < place.commands.size(); ++depth)
    for (const CLI::App* app : place.commands[depth]->get_subcommands({}))
      if (!app->get_group().empty() && std::ranges::find(place.commands, app) == place.commands.end())
        names.push_back(app->get_name());
  return names;
}

std::vector<std::string> beginningWith(const std::string& begin, std::vector<std::string> words) {
  std::erase_if(words, [&](const std::string& word) { return !word.starts_with(begin); });
  std::ranges::sort(words);
  words.erase(std::unique(words.begin(), words.end()), words.end());
  return words;
}

// "--name", "=", "value" and "builtin", ":", "press" as one word each. `tail`: length of the part of the last word that
// the shell replaces.
std::vector<std::string> joined(const std::vector<std::string>& words, std::size_t& tail) {
  std::vector<std::string> whole;
  bool joins = false;
  tail = std::string::npos;
  for (const std::string& word : words) {
    const bool isSign = !whole.empty() && (word == ":" || (word == "=" && isOption(whole.back())));
    if (joins || isSign) {
      whole.back() += word;
      tail = isSign ? 0 : word.size();
    } else {
      whole.push_back(word);
      tail = std::string::npos;
    }
    joins = isSign;
  }
  return whole;
}

// Completions of a value, or of the last one in a list of values.
Completions valuesOf(const Options& program, const CLI::Option& option, const std::string& begin) {
  const OptionFacts* facts = program.factsOf(&option);
  Completions found = filesOf(option);
  if (facts && !facts->endings.empty()) found = {.files = true, .endings = endingsIn(facts->endings)};
  const std::vector<std::string> choices = choicesOf(option, facts);
  const char separator = option.get_delimiter();
  const std::size_t last = separator ? begin.rfind(separator) : begin.npos, from = last == begin.npos ? 0 : last + 1;
  found.words = beginningWith(begin.substr(from), choices);
  for (std::string& word : found.words) word.insert(0, begin.substr(0, from));
  return found;
}

}  // namespace

Completions completionsOf(const Options& program, const std::vector<std::string>& words) {
  std::size_t tail = 0;
  std::vector<std::string> whole = joined(words, tail);
  const std::string current = whole.empty() ? std::string() : whole.back();
  if (!whole.empty()) whole.pop_back();
  Place place{.commands = {&program.app()}};
  for (const std::string& word : whole) place.pass(word);

  Completions found;
  std::string before;  // of the value, in the current word
  if (const std::size_t sign = current.find('='); isOption(current) && sign != current.npos) {
    before = current.substr(0, sign + 1);
    if (const CLI::Option* option = place.find(current.substr(0, sign)))
      found = valuesOf(program, *option, current.substr(sign + 1));
  } else if (isOption(current)) {
    found.words = beginningWith(current, optionNames(place));
  } else if (place.option) {
    found = valuesOf(program, *place.option, current);
  } else {
    if (const CLI::Option* positional = place.positional()) found = valuesOf(program, *positional, current);
    if (place.commands.size() == 1 && place.positionals == 0) found = {.files = true};  // palpate MODEL
    std::ranges::move(beginningWith(current, subcommandNames(place)), std::back_inserter(found.words));
    std::ranges::sort(found.words);
  }
  for (std::string& word : found.words) {
    word.insert(0, before);
    if (tail != std::string::npos) word.erase(0, current.size() - tail);
  }
  return found;
}

}  // namespace palpate
