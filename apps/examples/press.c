/* A servo loop of the caller: a ball of 20,000 points of 50 mm, and a hand that presses 1 mm into it. */
#include <math.h>
#include <palpate/palpate.h>
#include <stdio.h>
#include <stdlib.h>

#define POINTS 20000

static float positions[3 * POINTS], normals[3 * POINTS];

static void expect(pp_status status) {
  if (status == PP_OK) return;
  fprintf(stderr, "press: %s: %s\n", pp_status_name(status), pp_last_error());
  exit(1);
}

static void make_ball(void) {
  for (int i = 0; i < POINTS; ++i) {
    const double z = 1 - (2.0 * i + 1) / POINTS, r = sqrt(1 - z * z),
                 turn = 2 * 3.141592653589793 * i / 1.618033988749895;
    const double normal[3] = {r * cos(turn), r * sin(turn), z};
    for (int k = 0; k < 3; ++k) {
      normals[3 * i + k] = (float)normal[k];
      positions[3 * i + k] = (float)(50 * normal[k]);
    }
  }
}

int main(void) {
  make_ball();
  pp_cloud_arrays arrays = pp_default_cloud_arrays();
  arrays.count = POINTS;
  arrays.positions.data = positions;
  arrays.normals.data = normals;
  pp_cloud cloud;
  expect(pp_cloud_create(&arrays, &cloud));

  pp_session_options options = pp_default_session_options();
  options.gpu = "cpu";
  options.mm_per_unit = 1;
  options.budget_us = 500;
  pp_session session;
  expect(pp_session_open(cloud, &options, &session));
  expect(pp_cloud_close(cloud));

  pp_contact contact = {0};
  for (int tick = 0; tick < 200; ++tick) {
    pp_pose pose = {0};
    pose.t_s = 1e-3 * tick;
    pose.hip[2] = tick < 100 ? 51 - 0.02 * tick : 49;
    expect(pp_touch(session, &pose, &contact));
  }
  printf("%s: %.3f N at %.3f mm\n", pp_version(), contact.force_N[2], contact.penetration_mm);
  expect(pp_session_close(session));
  return 0;
}
