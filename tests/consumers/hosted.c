/* A program with a servo loop of its own, like a simulator or a device's library: its thread wakes every
 * millisecond and queries the surface, while another thread of the program reads the session's state. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <palpate/palpate.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define POINTS 20000
#define TICKS 2000
#define PERIOD_NS 1000000

static float positions[3 * POINTS], normals[3 * POINTS];

typedef struct loop {
  pp_session session;
  int missed; /* wakes that came more than a period late */
  int wrong;  /* wrong forces */
  int failed; /* failed calls */
  pp_contact last;
} loop;

static void expect(pp_status status) {
  if (status == PP_OK) return;
  fprintf(stderr, "hosted: %s: %s\n", pp_status_name(status), pp_last_error());
  exit(1);
}

static void make_ball(void) {
  for (int i = 0; i < POINTS; ++i) {
    const double z = 1 - (2.0 * i + 1) / POINTS, r = sqrt(1 - z * z);
    const double turn = 2 * 3.141592653589793 * i / 1.618033988749895;
    const double normal[3] = {r * cos(turn), r * sin(turn), z};
    for (int k = 0; k < 3; ++k) {
      normals[3 * i + k] = (float)normal[k];
      positions[3 * i + k] = (float)(50 * normal[k]);
    }
  }
}

/* From 2 mm above the ball to 1 mm below its surface in half of the ticks, then at rest. */
static double height(int tick) { return tick < TICKS / 2 ? 52 - 3.0 * tick / (TICKS / 2) : 49; }

/* At 0.8 N/mm; allows for damping and a slightly late answer. */
static int is_right(int tick, const pp_contact* contact) {
  const double force = contact->force_N[2];
  if (!contact->valid || fabs(contact->force_N[0]) > 0.1 || fabs(contact->force_N[1]) > 0.1) return 0;
  if (height(tick) > 50.3) return force == 0;
  if (tick > TICKS / 2 + 200) return force > 0.7 && force < 0.9;
  return force >= 0 && force < 1.2;
}

static void* servo(void* given) {
  loop* mine = given;
  struct timespec due, now;
  clock_gettime(CLOCK_MONOTONIC, &due);
  for (int tick = 0; tick < TICKS; ++tick) {
    pp_pose pose = {0};
    pose.t_s = 1e-9 * PERIOD_NS * tick;
    pose.hip[2] = height(tick);
    mine->failed += pp_touch(mine->session, &pose, &mine->last) != PP_OK;
    mine->wrong += !is_right(tick, &mine->last);
    due.tv_nsec += PERIOD_NS;
    if (due.tv_nsec >= 1000000000) {
      due.tv_nsec -= 1000000000;
      ++due.tv_sec;
    }
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, NULL);
    clock_gettime(CLOCK_MONOTONIC, &now);
    if (now.tv_sec - due.tv_sec + 1e-9 * (double)(now.tv_nsec - due.tv_nsec) > 1e-9 * PERIOD_NS) {
      ++mine->missed;
      due = now; /* restart the schedule here instead of running many ticks in a row */
    }
  }
  return NULL;
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
  loop mine = {0};
  expect(pp_session_open(cloud, &options, &mine.session));
  expect(pp_cloud_close(cloud));

  pthread_t thread;
  if (pthread_create(&thread, NULL, servo, &mine) != 0) {
    fprintf(stderr, "hosted: no thread\n");
    return 1;
  }
  for (int look = 0; look < 30; ++look) {
    const struct timespec pause = {0, 33000000};
    pp_session_info info = pp_default_session_info();
    expect(pp_session_get_info(mine.session, &info));
    expect(pp_session_apply_edits(mine.session));
    nanosleep(&pause, NULL);
  }
  pthread_join(thread, NULL);
  printf("%s: %.3f N at %.3f mm; of %d ticks %d were missed, %d had a wrong force, %d failed\n", pp_version(),
         mine.last.force_N[2], mine.last.penetration_mm, TICKS, mine.missed, mine.wrong, mine.failed);
  expect(pp_session_close(mine.session));
  return mine.wrong == 0 && mine.failed == 0 ? 0 : 1;
}
