#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// A camera that the user has given a name; `camera` is a text for `render --camera`.
struct NamedView {
  std::string name, camera;
};

/// The named views of models: kept in $XDG_STATE_HOME/palpate/views (or as RecentFiles), one per line: model, name and
/// camera with tabs between them. If that file cannot be read or written, or a model cannot be found again by name, its
/// views last as long as the program.
class NamedViews {
 public:
  static constexpr std::size_t kMax = 1000;  ///< of all models; the oldest are forgotten

  NamedViews();
  /// In the order in which they were added.
  std::vector<NamedView> of(const std::string& model) const;
  /// Replaces a view of that name. Without a name it gets one: view 1, view 2 and so on. Returns the name.
  std::string remember(const std::string& model, NamedView view);
  void forget(const std::string& model, const std::string& name);

 private:
  struct Entry {
    std::string model;
    NamedView view;
    bool isStored;
  };
  void load();
  void store() const;

  std::filesystem::path store_;  // empty: they are not stored
  std::vector<Entry> entries_;
};

}  // namespace palpate
