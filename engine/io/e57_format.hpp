// E57 (ASTM E2807), the scans of terrestrial laser scanners, as a format that is read.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

CloudFormat e57Format();

}  // namespace palpate
