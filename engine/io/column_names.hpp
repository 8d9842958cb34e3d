// Names of point columns in files.
#pragma once

#include <string>
#include <string_view>

namespace palpate {

/// The name that all formats share for the meaning of `name`, case-insensitive: x for X, Easting, pos_x; nx for
/// normal_x; red for Red. Other names become lower case, without a unit in brackets.
std::string sharedColumnName(std::string_view name);

}  // namespace palpate
