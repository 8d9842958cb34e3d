// What the command line may say, as the subcommands declare it. CLI11 does the work: it is compiled with options.cpp,
// complaint.cpp, completion.cpp and main.cpp alone, because each file that reads it takes ten seconds longer.
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace palpate {

/// What a value has to be.
struct Check {
  std::function<std::string(const std::string&)> complaint;  ///< what is wrong with a text; empty where it fits
  std::string description = {};                              ///< stands in the help in place of the type
};
/// One of these words. Throws nothing.
Check oneOf(std::vector<std::string> words);
Check oneOf(std::initializer_list<std::uint32_t> numbers);
/// A whole number within bounds that the help shows.
Check inRange(std::uint32_t least, std::uint32_t most);
/// Numbers, with complaints that say the bounds. Not-a-number and infinity never pass.
Check between(double least, double most);
/// The same of a number without a fraction.
Check wholeBetween(double least, double most);
/// A length in mm, or the word auto.
Check lengthOrAuto();

/// One of Options, which outlive it.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option required();
  Option check(const Check& check);
  Option typeName(const std::string& name);
  Option describe(const std::string& what);
  /// Several values may stand in one word, with this between them.
  Option separatedBy(char separator);
  /// The help shows the value that the variable has now.
  Option showDefault();
  Option needs(Option other);
  Option excludes(Option other);
  /// Under which heading the help lists it; an empty one hides it.
  Option under(const std::string& heading);
  /// As if the command line had said so.
  void set(const std::string& text);

  /// As the complaints call it: "--tool-radius", or "model" without a dash.
  std::string name() const;
  /// "--tool-radius", also where the help hides it. Only of options that have such a name.
  std::string longName() const;
  bool given() const;
  bool takesValue() const;
  /// The first value that was given.
  std::string text() const;
  /// What showDefault() shows.
  std::string defaultText() const;

 private:
  CLI::Option* option_;
};

/// The options of a command and its subcommands. The variables they are read into outlive it.
class Options {
 public:
  Options();
  explicit Options(const std::string& description);
  ~Options();
  Options(const Options&) = delete;
  Options& operator=(const Options&) = delete;

  /// `names` are separated by commas; one without a dash is known by its place. `what` is for the help.
  Option add(const std::string& names, std::string& value, const std::string& what);
  Option add(const std::string& names, double& value, const std::string& what);
  Option add(const std::string& names, std::int64_t& value, const std::string& what);
  Option add(const std::string& names, std::uint32_t& value, const std::string& what);
  Option add(const std::string& names, std::uint64_t& value, const std::string& what);
  Option add(const std::string& names, std::optional<std::uint32_t>& value, const std::string& what);
  Option add(const std::string& names, std::vector<std::string>& values, const std::string& what);
  Option add(const std::string& names, std::vector<std::int64_t>& values, const std::string& what);
  Option add(const std::string& names, std::vector<std::uint32_t>& values, const std::string& what);
  Option addFlag(const std::string& names, bool& value, const std::string& what);
  /// One that stands for the first of some words, and takes another only as --name=word.
  Option addFlag(const std::string& name, std::string& value, const std::vector<std::string>& words,
                 const std::string& what);
  /// Options that are added from now on stand under this heading.
  void heading(const std::string& text);

  Options& addSubcommand(const std::string& name, const std::string& what);
  /// The help of the command above lists this one there.
  void under(const std::string& heading);
  /// 0 for `most`: as many as there are.
  void requireSubcommands(std::size_t least, std::size_t most);
  /// What help ends with.
  void footer(const std::string& text);
  /// --help lists only these options, named as "--rate"; --help-all lists all of them.
  void helpShows(std::vector<std::string> names);
  /// Runs once the command line has been read, when it names this subcommand.
  void whenNamed(std::function<void()> callback);

  std::string name() const;
  std::vector<Option> all() const;
  /// Throws std::exception where there is no option of that name.
  Option find(const std::string& name) const;
  const std::vector<std::unique_ptr<Options>>& subcommands() const { return subcommands_; }
  /// Those that the command line named, in its order.
  std::vector<const Options*> named() const;

  /// Reads what the words of a command line say. Throws std::exception that says what is wrong.
  void parse(std::vector<std::string> arguments);
  CLI::App& app() { return *app_; }

 private:
  explicit Options(CLI::App& subcommand);
  std::unique_ptr<CLI::App> own_;  // of the command above all
  CLI::App* app_;
  std::vector<std::unique_ptr<Options>> subcommands_;
};

}  // namespace palpate
