#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// A text that the user has given a name: a camera for `render --camera`, or a measured distance.
struct NamedText {
  std::string name, text;
};

/// The named texts of models, of one kind: kept in a file of $XDG_STATE_HOME/palpate (or as RecentFiles), one per
/// line: model, name and text with tabs between them. If that file cannot be read or written, or a model cannot be
/// found again by name, its texts last as long as the program.
class NamedTexts {
 public:
  static constexpr std::size_t kMax = 1000;  ///< of all models; the oldest are forgotten

  /// `kind` begins the names that are given: view 1, view 2 and so on.
  NamedTexts(const char* file, std::string kind);
  /// In the order in which they were added.
  std::vector<NamedText> of(const std::string& model) const;
  /// Replaces a text of that name. Without a name it gets one. Returns the name.
  std::string remember(const std::string& model, NamedText named);
  void forget(const std::string& model, const std::string& name);

 private:
  struct Entry {
    std::string model;
    NamedText named;
    bool isStored;
  };
  void load();
  void store() const;

  std::filesystem::path store_;  // empty: they are not stored
  std::string kind_;
  std::vector<Entry> entries_;
};

}  // namespace palpate
