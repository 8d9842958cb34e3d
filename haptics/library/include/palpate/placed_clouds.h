/** @file
 * palpate's C interface: several clouds in the space of one session. palpate.h includes this. */
#ifndef PALPATE_PLACED_CLOUDS_H
#define PALPATE_PLACED_CLOUDS_H
#ifndef PALPATE_H
#error "include <palpate/palpate.h>, which includes this header"
#endif

/** @defgroup placed Several clouds in one session
 * @{ */

/** A cloud and its pose in the session's space: position in the session = rotated position in the cloud + position. */
typedef struct pp_placed_cloud {
  pp_cloud cloud;        /**< may be placed any number of times */
  double orientation[4]; /**< unit quaternion w x y z; all zero: no rotation */
  double position[3];    /**< model units of the session */
} pp_placed_cloud;

/** Opens a session of several clouds at rest, which hands feel and sculpt as one. Normals of a cloud without any are
 * estimated from its own points. Of the clouds, positions, normals and colours are taken; where only some have colours,
 * the others are the colour of clay. pp_session_rows(), pp_session_nearest() and pp_session_raycast() say which cloud
 * and row a point comes from. `mm_per_unit` 0: the longest side of all together becomes 100 mm. Errors as for
 * pp_session_open(); PP_ERROR_ARGUMENT names the cloud whose pose is not finite or not a rotation. */
PP_API pp_status pp_session_open_clouds(const pp_placed_cloud* clouds, uint64_t count,
                                        const pp_session_options* options, pp_session* session);

/** @} */

#endif
