// What a person reads while a command runs: on stderr, a bar on a terminal, plain lines otherwise.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

namespace palpate {

/// A sink for remarks and progress. Passed to whoever has something to say; there is no global one.
class Log {
 public:
  explicit Log(bool quiet = false);

  template <class... Args>
  void say(fmt::format_string<Args...> text, Args&&... args) {
    write(fmt::format(text, std::forward<Args>(args)...));
  }
  /// `fraction` from 0 to 1; lines are rationed, so it may be called often.
  void progress(std::string_view what, double fraction);

 private:
  void write(std::string_view line);
  void clearBar();

  bool quiet_;
  bool terminal_;
  int lastTenth_ = -1;
  bool barShown_ = false;
};

}  // namespace palpate
