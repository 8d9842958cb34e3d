// PLY as one of the formats.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

CloudFormat plyFormat();

}  // namespace palpate
