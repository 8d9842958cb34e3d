#include "apps/cli/options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>

#include "engine/core/unknown_name.hpp"
#include "haptics/session/bounds.hpp"

namespace palpate {

namespace {

// The number that the whole text represents; empty if it is not a finite number.
std::optional<double> finiteNumber(const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || last != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

bool isBetween(const std::string& text, double least, double most) {
  const auto value = finiteNumber(text);
  return value && *value >= least && *value <= most;
}

Check wanted(std::string what, std::function<bool(const std::string&)> fits, std::string description,
             std::string bounds) {
  return {[what = std::move(what), fits = std::move(fits)](const std::string& text) {
            return fits(text) ? std::string() : fmt::format("{} is not {}", text, what);
          },
          std::move(description), std::move(bounds)};
}

// For the help; empty for bounds that only exclude absurd numbers.
std::string boundsInHelp(const Range& range) {
  constexpr double kAbsurd = 1e5;
  return range.max < kAbsurd ? inWords(range) : std::string();
}

// CLI11's validators may change the text; those used here only check it.
Check checkOf(const CLI::Validator& validator) {
  return {[validator](std::string text) { return validator(text); }, validator.get_description()};
}

// Lists the options that most sessions need, and refers to --help-all for the others.
class ShortHelp : public CLI::Formatter {
 public:
  explicit ShortHelp(std::vector<std::string> shown) : shown_(std::move(shown)) {}

  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    if (mode != CLI::AppFormatMode::Normal) return Formatter::make_help(app, name, mode);
    std::string help = make_description(app) + make_usage(app, name) + make_positionals(app);
    std::size_t others = 0;
    for (const std::string& group : app->get_groups()) {
      std::vector<const CLI::Option*> options = app->get_options([&](const CLI::Option* option) {
        return !group.empty() && option->get_group() == group && option->nonpositional();
      });
      others += std::erase_if(options, [&](const CLI::Option* option) {
        return option != app->get_help_ptr() && std::ranges::find(shown_, longName(option)) == shown_.end();
      });
      if (!options.empty()) help += make_group(group, false, options);
    }
    return help + fmt::format("\n{} more options: {} --help-all\n\n", others, name) + make_footer(app);
  }

 private:
  static std::string longName(const CLI::Option* option) {
    return option->get_lnames().empty() ? std::string() : "--" + option->get_lnames().front();
  }
  std::vector<std::string> shown_;
};

}  // namespace

Check oneOf(std::vector<std::string> words) {
  std::string description = fmt::format("{{{}}}", fmt::join(words, ","));
  return {[words = std::move(words)](const std::string& text) {
            if (std::ranges::find(words, text) != words.end()) return std::string();
            return unknownName("value", text, words);
          },
          std::move(description)};
}

Check oneOf(std::initializer_list<std::uint32_t> numbers) { return checkOf(CLI::IsMember(numbers)); }

Check inRange(std::uint32_t least, std::uint32_t most) { return wholeBetween(least, most); }

Check between(double least, double most) { return between(Range{least, most}); }

Check between(const Range& given) {
  Range range = given;
  range.orZero = false;  // the option is left out instead
  return wanted(
      range.excludesMin ? fmt::format("a number {}", inWords(range))
                        : fmt::format("a number from {} to {}", range.min, range.max),
      [range](const std::string& text) {
        const auto value = finiteNumber(text);
        return value && range.contains(*value);
      },
      boundsInHelp(range), inWords(range));
}

Check wholeBetween(double least, double most) {
  return wanted(
      fmt::format("a whole number from {:.0f} to {:.0f}", least, most),
      [least, most](const std::string& text) {
        return isBetween(text, least, most) && text.find_first_not_of("+-0123456789") == text.npos;
      },
      boundsInHelp({least, most}), inWords(Range{least, most}));
}

Check lengthOrAuto() {
  return wanted(
      fmt::format("auto or a length from {} to {} mm", bounds::kShortest_mm, bounds::kLongest_mm),
      [](const std::string& text) {
        return text == "auto" || isBetween(text, bounds::kShortest_mm, bounds::kLongest_mm);
      },
      {}, fmt::format("auto, {}", inWords(Range{bounds::kShortest_mm, bounds::kLongest_mm})));
}

Option Option::required() { return option_->required(), *this; }
Option Option::check(const Check& check) {
  option_->check(check.complaint, check.description);
  if (!check.bounds.empty()) facts_->bounds = check.bounds;
  return *this;
}
Option Option::typeName(const std::string& name) { return option_->type_name(name), *this; }
Option Option::describe(const std::string& what) { return option_->description(what), *this; }
Option Option::repeatable() { return option_->allow_extra_args(false), *this; }
Option Option::separatedBy(char separator) { return option_->delimiter(separator), *this; }
Option Option::showDefault() { return option_->capture_default_str(), *this; }
Option Option::needs(Option other) { return option_->needs(other.option_), *this; }
Option Option::excludes(Option other) { return option_->excludes(other.option_), *this; }
Option Option::under(const std::string& heading) { return option_->group(heading), *this; }

Option Option::unit(std::string_view unit) {
  facts_->unit = unit;
  return *this;
}

Option Option::offers(std::vector<std::string> words, std::string endings) {
  facts_->offers = std::move(words);
  facts_->endings = std::move(endings);
  return *this;
}

Option Option::writes(Writes writes, std::string key) {
  facts_->writes = writes;
  facts_->fileKey = std::move(key);
  return *this;
}

void Option::replace(const std::string& text, const std::string& by) {
  std::vector<std::string> all = texts();
  std::ranges::replace(all, text, by);
  option_->clear();
  option_->add_result(all);
  option_->run_callback();
}

std::string Option::name() const { return option_->get_name(); }
std::string Option::longName() const { return "--" + option_->get_lnames().front(); }
bool Option::given() const { return option_->count() > 0; }
bool Option::takesValue() const { return option_->get_expected_min() > 0; }
std::string Option::text() const { return option_->results().front(); }
std::vector<std::string> Option::texts() const { return option_->results(); }
std::string Option::defaultText() const { return option_->get_default_str(); }
std::string Option::allNames() const { return option_->get_name(false, true); }
std::string Option::type() const { return option_->get_type_name(); }
std::string Option::help() const { return option_->get_description(); }
std::string Option::heading() const { return option_->get_group(); }
bool Option::isRequired() const { return option_->get_required(); }

Options::Options() : Options(std::string()) {}
Options::Options(const std::string& description) : own_(std::make_unique<CLI::App>(description)), app_(own_.get()) {}
Options::Options(CLI::App& subcommand) : app_(&subcommand) {}
Options::~Options() = default;

Option Options::with(CLI::Option* option) const { return {option, &facts_[option]}; }

Option Options::add(const std::string& names, std::string& value, const std::string& what) {
  return with(app_->add_option(names, value, what));
}
Option Options::add(const std::string& names, double& value, const std::string& what) {
  return with(app_->add_option(names, value, what));
}
Option Options::add(const std::string& names, std::int64_t& value, const std::string& what) {
  return with(app_->add_option(names, value, what));
}
Option Options::add(const std::string& names, std::uint32_t& value, const std::string& what) {
  return with(app_->add_option(names, value, what));
}
Option Options::add(const std::string& names, std::uint64_t& value, const std::string& what) {
  return with(app_->add_option(names, value, what));
}
Option Options::add(const std::string& names, std::optional<std::uint32_t>& value, const std::string& what) {
  return with(app_->add_option(names, value, what));
}
Option Options::add(const std::string& names, std::vector<std::string>& values, const std::string& what) {
  return with(app_->add_option(names, values, what));
}
Option Options::add(const std::string& names, std::vector<std::int64_t>& values, const std::string& what) {
  return with(app_->add_option(names, values, what));
}
Option Options::add(const std::string& names, std::vector<std::uint32_t>& values, const std::string& what) {
  return with(app_->add_option(names, values, what));
}
Option Options::add(const std::string& names, const std::function<void(const std::string&)>& set,
                    const std::function<std::string()>& usual, const std::string& what) {
  CLI::Option* option = app_->add_option_function<std::string>(names, set, what);
  return with(option->default_function(usual));
}
Option Options::addFlag(const std::string& names, bool& value, const std::string& what) {
  return with(app_->add_flag(names, value, what));
}
Option Options::addNegatedFlag(const std::string& names, bool& value, const std::string& what) {
  return with(app_->add_flag_callback(
      names, [&value] { value = false; }, what));
}

Option Options::addFlag(const std::string& name, std::string& value, const std::vector<std::string>& words,
                        const std::string& what) {
  return with(app_->add_flag(name + "{" + words.front() + "}", value, what)->check(CLI::IsMember(words)));
}

Option Options::addFlag(const std::string& name, std::string& value, const std::string& usual,
                        const std::string& what) {
  return with(app_->add_flag(name + "{" + usual + "}", value, what));
}

void Options::heading(const std::string& text) { app_->option_defaults()->group(text); }

Options& Options::addSubcommand(const std::string& name, const std::string& what) {
  subcommands_.emplace_back(new Options(*app_->add_subcommand(name, what)));
  return *subcommands_.back();
}

void Options::under(const std::string& heading) { app_->group(heading); }
void Options::requireSubcommands(std::size_t least, std::size_t most) { app_->require_subcommand(least, most); }
void Options::footer(const std::string& text) { app_->footer(text); }
void Options::helpShows(std::vector<std::string> names) {
  app_->formatter(std::make_shared<ShortHelp>(std::move(names)));
}
void Options::whenNamed(std::function<void()> callback) { app_->callback(std::move(callback)); }

std::string Options::name() const { return app_->get_name(); }
std::string Options::description() const { return app_->get_description(); }
std::string Options::footer() const { return app_->get_footer(); }

std::vector<Option> Options::all() const {
  std::vector<Option> options;
  for (CLI::Option* option : app_->get_options({})) options.push_back(with(option));
  return options;
}

Option Options::find(const std::string& name) const { return with(app_->get_option(name)); }

const OptionFacts* Options::factsOf(const CLI::Option* option) const {
  if (const auto found = facts_.find(option); found != facts_.end()) return &found->second;
  for (const auto& subcommand : subcommands_)
    if (const OptionFacts* found = subcommand->factsOf(option)) return found;
  return nullptr;
}

std::vector<const Options*> Options::named() const {
  std::vector<const Options*> named;
  for (const CLI::App* app : app_->get_subcommands())
    for (const auto& subcommand : subcommands_)
      if (subcommand->app_ == app) named.push_back(subcommand.get());
  return named;
}

void Options::parse(std::vector<std::string> arguments) {
  std::ranges::reverse(arguments);  // the order that CLI11 expects
  app_->parse(std::move(arguments));
}

}  // namespace palpate
