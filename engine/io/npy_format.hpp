// Arrays of NumPy as formats: NPY, one array, and NPZ, several with names.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

CloudFormat npyFormat();
CloudFormat npzFormat();

}  // namespace palpate
