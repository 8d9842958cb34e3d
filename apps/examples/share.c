/* A cloud that one program serves and others join and dent, each a process of its own:
 *   share serve DOMAIN       until a line is read; then prints a hash of its points
 *   share join DOMAIN X      dents the ball at X, prints a hash of its points, and ends without closing anything
 * 77: this library was built without PALPATE_NETWORK. */
#include <math.h>
#include <palpate/palpate.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define POINTS 5000
#define TICKS 200
#define NAME "the ball of share"

static float positions[3 * POINTS], normals[3 * POINTS];

static void expect(pp_status status) {
  if (status == PP_OK) return;
  fprintf(stderr, "share: %s: %s\n", pp_status_name(status), pp_last_error());
  exit(status == PP_ERROR_UNSUPPORTED ? 77 : 1);
}

static pp_cloud ball(void) {
  for (int i = 0; i < POINTS; ++i) {
    const double z = 1 - (2.0 * i + 1) / POINTS, r = sqrt(1 - z * z),
                 turn = 2 * 3.141592653589793 * i / 1.618033988749895;
    const double normal[3] = {r * cos(turn), r * sin(turn), z};
    for (int k = 0; k < 3; ++k) {
      normals[3 * i + k] = (float)normal[k];
      positions[3 * i + k] = (float)(50 * normal[k]);
    }
  }
  pp_cloud_arrays arrays = pp_default_cloud_arrays();
  arrays.count = POINTS;
  arrays.positions.data = positions;
  arrays.positions.type = PP_FLOAT32;
  arrays.normals = arrays.positions;
  arrays.normals.data = normals;
  pp_cloud cloud;
  expect(pp_cloud_create(&arrays, &cloud));
  return cloud;
}

/* FNV-1a of all bits of the points. */
static void say_points(pp_cloud cloud) {
  pp_points points;
  expect(pp_cloud_view(cloud, &points));
  uint64_t sum = 14695981039346656037u;
  const float* const both[] = {points.positions, points.normals};
  for (int k = 0; k < 2; ++k)
    for (size_t i = 0; i < 3 * points.count * sizeof(float); ++i)
      sum = (sum ^ ((const unsigned char*)both[k])[i]) * 1099511628211u;
  printf("points %016llx\n", (unsigned long long)sum);
  expect(pp_cloud_close(cloud));
}

static void serve(const pp_network* network) {
  pp_serve_options options = pp_default_serve_options();
  options.network = network;
  options.mm_per_unit = 1;
  const pp_cloud cloud = ball();
  pp_server server;
  expect(pp_serve(cloud, NAME, &options, &server));
  expect(pp_cloud_close(cloud)); /* the server keeps what it needs of it */
  puts("serving");
  fflush(stdout);
  getchar();
  pp_server_info info = pp_default_server_info();
  expect(pp_server_get_info(server, &info));
  pp_cloud now;
  expect(pp_server_cloud(server, &now));
  printf("sculptors %llu\n", (unsigned long long)info.sculptors);
  say_points(now);
  expect(pp_server_close(server));
}

static void dent(const pp_network* network, double x) {
  pp_join_options join = pp_default_join_options();
  join.network = network;
  join.timeout_s = 30;
  pp_session_options options = pp_default_session_options();
  options.gpu = "cpu";
  pp_session session;
  expect(pp_session_join(NAME, &join, &options, &session));
  static double way[3 * TICKS];
  for (int i = 0; i < TICKS; ++i) {
    const double down = i < TICKS / 2 ? 2.0 * i / TICKS : 1;
    way[3 * i] = x;
    way[3 * i + 2] = 52 - 5 * down;
  }
  pp_path path = pp_default_path();
  path.data = way;
  path.rows = TICKS;
  const pp_brush brush = pp_default_brush();
  static pp_tick ticks[TICKS];
  uint64_t count = 0;
  expect(pp_session_stroke(session, &path, &brush, ticks, TICKS, &count));
  uint32_t same = 0;
  expect(pp_session_settle(session, 30, &same));
  if (!same || !ticks[count - 1].contact) {
    fprintf(stderr, "share: the points are not the server's, or nothing was touched\n");
    exit(1);
  }
  pp_cloud now;
  expect(pp_session_cloud(session, &now));
  say_points(now);
}

int main(int argc, char** argv) {
  if (argc < 3 || (strcmp(argv[1], "serve") != 0 && strcmp(argv[1], "join") != 0)) {
    fputs("usage: share serve DOMAIN, or share join DOMAIN X\n", stderr);
    return 2;
  }
  pp_network network = pp_default_network();
  network.domain = (uint32_t)atoi(argv[2]);
  if (strcmp(argv[1], "serve") == 0)
    serve(&network);
  else
    dent(&network, argc > 3 ? atof(argv[3]) : 0);
  return 0;
}
