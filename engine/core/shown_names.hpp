// Names that messages and results show in place of others, for the whole program: a temporary file is shown by what it
// is for.
#pragma once

#include <string>

namespace palpate {

/// From now on `name` is shown as `shown`, from any thread.
void showAs(std::string name, std::string shown);
/// A text with the names that are shown.
std::string withShownNames(std::string text);

}  // namespace palpate
