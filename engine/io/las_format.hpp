// LAS 1.0 to 1.4, the files of laser scanners, as a format.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

CloudFormat lasFormat();

}  // namespace palpate
