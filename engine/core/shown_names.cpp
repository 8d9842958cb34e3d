#include "engine/core/shown_names.hpp"

#include <mutex>
#include <utility>
#include <vector>

namespace palpate {

namespace {

struct Names {
  std::mutex lock;  // guards the member below
  std::vector<std::pair<std::string, std::string>> shown;
};

Names& names() {
  static Names all;
  return all;
}

}  // namespace

void showAs(std::string name, std::string shown) {
  const std::scoped_lock hold(names().lock);
  names().shown.emplace_back(std::move(name), std::move(shown));
}

std::string withShownNames(std::string text) {
  const std::scoped_lock hold(names().lock);
  for (const auto& [name, shown] : names().shown)
    for (std::size_t at = 0; (at = text.find(name, at)) != text.npos; at += shown.size())
      text.replace(at, name.size(), shown);
  return text;
}

}  // namespace palpate
