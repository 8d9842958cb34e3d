#include "apps/view/named_texts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <utility>

#include "apps/view/recent_files.hpp"
#include "engine/core/atomic_file.hpp"

namespace palpate {

namespace {

std::string keyOf(const std::string& model) {
  const std::string lasting = lastingName(model);
  return lasting.empty() ? model : lasting;
}

bool fitsLine(const std::string& text) { return text.find_first_of("\t\r\n") == text.npos; }

}  // namespace

NamedTexts::NamedTexts(const char* file, std::string kind) : store_(stateFile(file)), kind_(std::move(kind)) { load(); }

std::vector<NamedText> NamedTexts::of(const std::string& model) const {
  const std::string key = keyOf(model);
  std::vector<NamedText> named;
  for (const Entry& entry : entries_)
    if (entry.model == key) named.push_back(entry.named);
  return named;
}

std::string NamedTexts::remember(const std::string& model, NamedText named) {
  load();  // another window may have changed them
  std::ranges::replace_if(
      named.name, [](char c) { return !fitsLine(std::string(1, c)); }, ' ');
  const std::string key = keyOf(model);
  const auto find = [&](const std::string& name) {
    return std::ranges::find_if(entries_, [&](const Entry& e) { return e.model == key && e.named.name == name; });
  };
  for (int k = 1; named.name.empty(); ++k)
    if (const std::string name = fmt::format("{} {}", kind_, k); find(name) == entries_.end()) named.name = name;
  if (const auto old = find(named.name); old != entries_.end())
    old->named = named;
  else
    entries_.push_back({key, named, !lastingName(model).empty() && fitsLine(key)});
  if (entries_.size() > kMax) entries_.erase(entries_.begin());
  store();
  return named.name;
}

void NamedTexts::forget(const std::string& model, const std::string& name) {
  load();
  const std::string key = keyOf(model);
  std::erase_if(entries_, [&](const Entry& e) { return e.model == key && e.named.name == name; });
  store();
}

void NamedTexts::load() {
  std::ifstream in(store_);
  if (!in) return;
  std::erase_if(entries_, [](const Entry& e) { return e.isStored; });
  for (std::string line; std::getline(in, line);) {
    const std::size_t first = line.find('\t'), second = line.find('\t', first + 1);
    if (first == line.npos || second == line.npos) continue;
    entries_.push_back(
        {line.substr(0, first), {line.substr(first + 1, second - first - 1), line.substr(second + 1)}, true});
  }
}

void NamedTexts::store() const {
  if (store_.empty()) return;
  try {
    std::filesystem::create_directories(store_.parent_path());
    AtomicFile out(store_);
    for (const auto& [model, named, isStored] : entries_)
      if (isStored) out.write(fmt::format("{}\t{}\t{}\n", model, named.name, named.text));
    out.commit();
  } catch (const std::exception&) {  // not important enough for an error
  }
}

}  // namespace palpate
