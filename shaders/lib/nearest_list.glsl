// The smallest of many squared distances, ascending.
#ifndef PALPATE_LIB_NEAREST_LIST_GLSL
#define PALPATE_LIB_NEAREST_LIST_GLSL

struct NearestList {
  float squared[kMaxNearest];
  uint count;
};

void keepNearest(inout NearestList list, uint most, float squared) {
  if (list.count == most && squared >= list.squared[most - 1]) return;
  uint at = min(list.count, most - 1);
  for (; at > 0 && list.squared[at - 1] > squared; --at) list.squared[at] = list.squared[at - 1];
  list.squared[at] = squared;
  list.count = min(list.count + 1, most);
}

// Drivers may round roots and quotients to one side; a mean of millions of distances would be off by that.
float roundedRoot(float squared) {
  precise const float root = sqrt(squared);
  return root > 0 ? root + 0.5 * fma(-root, root, squared) / root : 0;
}
float meanOf(float sum, uint count) {
  precise const float mean = sum / float(count);
  return mean + fma(-mean, float(count), sum) / float(count);
}

#endif
