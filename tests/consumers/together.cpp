// A served cloud and two hands that dent it, in one program: together
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <palpate/palpate.hpp>
#include <vector>

namespace {

pp::Cloud hump() {
  std::vector<double> places;
  for (int i = -40; i <= 40; ++i)
    for (int k = -40; k <= 40; ++k)
      places.insert(places.end(), {double(i), double(k), 10 * std::exp(-(i * i + k * k) / 400.0)});
  pp_cloud_arrays arrays = pp_default_cloud_arrays();
  arrays.count = places.size() / 3;
  arrays.positions = {places.data(), PP_FLOAT64, 0, 0};
  return pp::Cloud(arrays);
}

bool isSame(const pp::Cloud& a, const pp::Cloud& b) {
  const pp_points one = a.view(), two = b.view();
  const std::size_t bytes = 3 * sizeof(float) * one.count;
  return one.count == two.count && std::memcmp(one.positions, two.positions, bytes) == 0 &&
         std::memcmp(one.normals, two.normals, bytes) == 0;
}

}  // namespace

int main(int, char** words) try {
  pp_network network = pp_default_network();
  network.domain = static_cast<std::uint32_t>(std::atoi(words[1]));
  pp_serve_options serving = pp_default_serve_options();
  serving.network = &network;
  serving.mm_per_unit = 1;
  const pp::Cloud cloud = hump();
  const pp::Server server(cloud, "hump", serving);
  pp_join_options join = pp_default_join_options();
  join.network = &network;
  pp_session_options options = pp_default_session_options();
  options.gpu = "cpu";
  pp::Session one = pp::Session::joined("hump", join, options), two = pp::Session::joined("hump", join, options);
  const double at[] = {0, 0, 0, 12, 0.1, 0, 0, 7}, beside[] = {0, 4, 0, 12, 0.1, 4, 0, 6};
  one.stroke(pp::timedPath(at, 2));
  two.stroke(pp::timedPath(beside, 2));
  const bool same =
      one.settle() && two.settle() && isSame(one.cloud(), server.cloud()) && isSame(two.cloud(), server.cloud());
  std::printf("%s: %zu session, %llu states of points by %llu hands, %s\n", pp::version().c_str(),
              pp::discover(network, 0.5).size(), static_cast<unsigned long long>(server.info().states),
              static_cast<unsigned long long>(server.info().sculptors),
              same ? "the same everywhere" : "NOT the same everywhere");
  return same && server.info().sculptors == 2 && two.sharing().received > 0 && one.otherHands().size() <= 1 ? 0 : 1;
} catch (const pp::Error& error) {
  std::fprintf(stderr, "together: %s\n", error.what());
  return error.status() == PP_ERROR_UNSUPPORTED ? 77 : 1;
}
