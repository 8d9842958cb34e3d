// NumPy arrays as formats: NPY, one array, and NPZ, several named arrays.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

CloudFormat npyFormat();
CloudFormat npzFormat();

}  // namespace palpate
