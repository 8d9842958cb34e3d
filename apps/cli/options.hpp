// Command-line options as declared by the subcommands. Only options.cpp, complaint.cpp, completion.cpp and main.cpp
// include CLI11, because each file that does takes ten seconds longer to compile.
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/setting.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace palpate {

/// Requirement on a value.
struct Check {
  std::function<std::string(const std::string&)> complaint;  ///< describes what is wrong with a text; empty: valid
  std::string description = {};                              ///< shown in the help in place of the type
  std::string bounds = {};                                   ///< of a number, for the reference page
};
/// One of these words.
Check oneOf(std::vector<std::string> words);
Check oneOf(std::initializer_list<std::uint32_t> numbers);
/// An integer within bounds that the help shows.
Check inRange(std::uint32_t least, std::uint32_t most);
/// A number; complaints name the bounds. Not-a-number and infinity never pass.
Check between(double least, double most);
Check between(const Range& range);
/// The same for an integer.
Check wholeBetween(double least, double most);
/// A length in mm, or the word auto.
Check lengthOrAuto();

/// What becomes of an existing file that an option names.
enum class Writes {
  nothing,
  keeping,    ///< its command keeps what is there, where that could be missed
  replacing,  ///< it is replaced
};

/// What the reference page, completion and checkFileNames() know of an option beside its help.
struct OptionFacts {
  std::string bounds, unit;
  std::vector<std::string> offers;  ///< words
  std::string endings;              ///< of files beside them
  Writes writes = Writes::nothing;
  std::string fileKey;  ///< what precedes the name of the file within a value
};

/// An option of Options, which must outlive it.
class Option {
 public:
  Option(CLI::Option* option, OptionFacts* facts) : option_(option), facts_(facts) {}

  Option required();
  Option check(const Check& check);
  Option typeName(const std::string& name);
  Option describe(const std::string& what);
  /// An option with several values has one of them each time that it is given.
  Option repeatable();
  /// Several values may stand in one word, separated by this character.
  Option separatedBy(char separator);
  /// The help shows the present value of the variable as the default.
  Option showDefault();
  Option needs(Option other);
  Option excludes(Option other);
  /// Heading under which the help lists the option; empty: hidden.
  Option under(const std::string& heading);
  /// For the reference page, if the help does not name it after a comma.
  Option unit(std::string_view unit);
  /// Words that completion offers where the help lists no choices, and the endings of files beside them.
  Option offers(std::vector<std::string> words, std::string endings = {});
  /// Its value, or what follows `key` in it, names a file that the command writes.
  Option writes(Writes writes, std::string key = {});
  /// Replaces each value that is `text`, as if the other one had been given.
  void replace(const std::string& text, const std::string& by);

  /// The name in complaints: "--brush-radius", or "model" without dashes.
  std::string name() const;
  /// "--brush-radius", also for hidden options. Only for options with a long name.
  std::string longName() const;
  bool given() const;
  bool takesValue() const;
  /// The first given value.
  std::string text() const;
  /// All given values.
  std::vector<std::string> texts() const;
  /// The text that showDefault() shows.
  std::string defaultText() const;
  /// Names, as in "-o,--output"; the kind of value, as in "FLOAT" or "{on,off}"; the help.
  std::string allNames() const;
  std::string type() const;
  std::string help() const;
  /// Heading under which the help lists the option; empty: hidden.
  std::string heading() const;
  bool isRequired() const;
  const OptionFacts& facts() const { return *facts_; }

 private:
  CLI::Option* option_;
  OptionFacts* facts_;
};

/// The options of a command and its subcommands. The variables that receive the values must outlive it.
class Options {
 public:
  Options();
  explicit Options(const std::string& description);
  ~Options();
  Options(const Options&) = delete;
  Options& operator=(const Options&) = delete;

  /// `names` are separated by commas; one without a dash is positional. `what` is for the help.
  Option add(const std::string& names, std::string& value, const std::string& what);
  Option add(const std::string& names, double& value, const std::string& what);
  Option add(const std::string& names, std::int64_t& value, const std::string& what);
  Option add(const std::string& names, std::uint32_t& value, const std::string& what);
  Option add(const std::string& names, std::uint64_t& value, const std::string& what);
  Option add(const std::string& names, std::optional<std::uint32_t>& value, const std::string& what);
  Option add(const std::string& names, std::vector<std::string>& values, const std::string& what);
  Option add(const std::string& names, std::vector<std::int64_t>& values, const std::string& what);
  Option add(const std::string& names, std::vector<std::uint32_t>& values, const std::string& what);
  /// Passes the text to `set` once it has passed the checks. `usual` gives the default for the help.
  Option add(const std::string& names, const std::function<void(const std::string&)>& set,
             const std::function<std::string()>& usual, const std::string& what);
  Option addFlag(const std::string& names, bool& value, const std::string& what);
  /// A flag that sets the variable to false.
  Option addNegatedFlag(const std::string& names, bool& value, const std::string& what);
  /// A flag that means the first of these words; another word requires --name=word.
  Option addFlag(const std::string& name, std::string& value, const std::vector<std::string>& words,
                 const std::string& what);
  /// A flag that means `usual`, which has no comma; another value requires --name=value.
  Option addFlag(const std::string& name, std::string& value, const std::string& usual, const std::string& what);
  /// Sets the heading for options added later.
  void heading(const std::string& text);

  Options& addSubcommand(const std::string& name, const std::string& what);
  /// Sets the heading under which the parent command's help lists this one.
  void under(const std::string& heading);
  /// `most` 0: unlimited.
  void requireSubcommands(std::size_t least, std::size_t most);
  /// Text at the end of the help.
  void footer(const std::string& text);
  /// --help lists only these options, named as "--rate"; --help-all lists all of them.
  void helpShows(std::vector<std::string> names);
  /// Called once the command line has been read, if it names this subcommand.
  void whenNamed(std::function<void()> callback);

  std::string name() const;
  std::string description() const;
  std::string footer() const;
  std::vector<Option> all() const;
  /// Throws std::exception if there is no option of that name.
  Option find(const std::string& name) const;
  const std::vector<std::unique_ptr<Options>>& subcommands() const { return subcommands_; }
  /// Facts of an option of this command or of a subcommand; null if there are none.
  const OptionFacts* factsOf(const CLI::Option* option) const;
  /// The subcommands on the command line, in its order.
  std::vector<const Options*> named() const;

  /// Parses the words of a command line. Throws std::exception that describes the error.
  void parse(std::vector<std::string> arguments);
  CLI::App& app() { return *app_; }
  const CLI::App& app() const { return *app_; }

 private:
  explicit Options(CLI::App& subcommand);
  Option with(CLI::Option* option) const;

  std::unique_ptr<CLI::App> own_;  // of the top-level command
  mutable std::map<const CLI::Option*, OptionFacts> facts_;
  CLI::App* app_;
  std::vector<std::unique_ptr<Options>> subcommands_;
};

}  // namespace palpate
