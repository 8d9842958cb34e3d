// E57 (ASTM E2807), scans of terrestrial laser scanners, as a format for reading.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

CloudFormat e57Format();

}  // namespace palpate
