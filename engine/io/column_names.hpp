// Names that files give to the columns of points.
#pragma once

#include <string>
#include <string_view>

namespace palpate {

/// The name that all formats share for what `name` means, in whatever case it is written: x for X, Easting, pos_x; nx
/// for normal_x; red for Red. Other names in lower case, less a unit in brackets.
std::string sharedColumnName(std::string_view name);

}  // namespace palpate
