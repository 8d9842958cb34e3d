#include "apps/view/kept_settings.hpp"

#include <algorithm>
#include <fstream>

#include "apps/view/recent_files.hpp"
#include "apps/view/theme.hpp"
#include "engine/core/atomic_file.hpp"
#include "engine/core/named_values.hpp"

namespace palpate {

std::optional<KeptSettings> KeptSettings::read() {
  std::ifstream in(stateFile("window"));
  if (!in) return std::nullopt;
  KeptSettings kept;
  for (std::string name, value; in >> name >> value;) {
    if (name == "theme") kept.dark = valueNamed(kThemes, value).value_or(kept.dark);
    if (name == "text_size") kept.text_percent = valueNamed(kTextSizes, value).value_or(kept.text_percent);
    if (name == "first_steps") kept.firstSteps = value == "yes";
  }
  return kept;
}

void KeptSettings::write() const {
  const std::filesystem::path file = stateFile("window");
  if (file.empty()) return;
  try {
    std::filesystem::create_directories(file.parent_path());
    AtomicFile out(file);
    out.write(fmt::format("theme {}\ntext_size {}\nfirst_steps {}\n", nameOf(kThemes, dark), text_percent,
                          firstSteps ? "yes" : "no"));
    out.commit();
  } catch (const std::exception&) {  // not important enough for an error
  }
}

}  // namespace palpate
