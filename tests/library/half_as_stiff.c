/* A force law in a library of its own. */
#include <palpate/palpate.h>

__attribute__((visibility("default"))) void half_as_stiff(void* user, const pp_pose* pose, const pp_contact* contact,
                                                          double dt_s, double force_N[3]) {
  (void)user;
  (void)pose;
  (void)dt_s;
  for (int k = 0; k < 3; ++k) force_N[k] = 0.5 * contact->force_N[k];
}
