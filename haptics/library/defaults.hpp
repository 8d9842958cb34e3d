// Default values of the options of the C interface.
#pragma once

#include <palpate/palpate.h>

namespace palpate::library {

/// Zero, except for the specializations below.
template <class Options>
Options usual() {
  Options options{};
  options.size = sizeof(Options);
  return options;
}

template <>
pp_contact_options usual();
template <>
pp_tool usual();
template <>
pp_session_options usual();
template <>
pp_path usual();
template <>
pp_brush usual();
template <>
pp_picture_options usual();
template <>
pp_mesh_options usual();
template <>
pp_stream_options usual();
template <>
pp_join_options usual();

}  // namespace palpate::library
