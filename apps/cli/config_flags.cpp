#include "apps/cli/config_flags.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>

#include "apps/cli/options.hpp"
#include "haptics/session/settings.hpp"

namespace palpate {

namespace {

bool isOfName(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.' || c == '[' || c == ']';
}

}  // namespace

std::string inFlags(const ConfigError& error, const Options& command) {
  const std::vector<Option> options = command.all();
  const auto has = [&](std::string_view flag) {
    return std::ranges::any_of(options, [&](const Option& option) { return option.name() == flag; });
  };
  const std::string_view text = error.what();
  std::string said;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = at;
    while (end < text.size() && isOfName(text[end])) ++end;
    // After the field at its beginning, a sentence names others by their paths; a plain "hands" in it is a word.
    const std::string_view word = text.substr(at, end - at);
    const bool isField = at == 0 || word.find('.') != word.npos;
    const std::string flag = isField ? flagOf(word) : std::string();
    said += !flag.empty() && has(flag) ? flag : std::string(word);
    if (end < text.size()) said += text[end];
    at = end + 1;
  }
  return said;
}

}  // namespace palpate
