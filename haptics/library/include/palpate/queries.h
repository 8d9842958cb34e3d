/** @file
 * palpate's C interface: nearest positions and ray casts on the surface of a session. palpate.h includes this. */
#ifndef PALPATE_QUERIES_H
#define PALPATE_QUERIES_H
#ifndef PALPATE_H
#error "include <palpate/palpate.h>, which includes this header"
#endif

/** @defgroup queries Nearest positions and ray casts
 * @{ */

/** Number of a cloud to which no point of the program corresponds, because a brush has inserted the point. */
#define PP_INSERTED 4294967295u

/** A point of a session: where it comes from. */
typedef struct pp_row {
  uint64_t row;     /**< row in that cloud; of an inserted point: its number among all that were inserted */
  uint32_t cloud;   /**< index of the cloud: 0, or of pp_session_open_clouds(); PP_INSERTED: inserted by a brush */
  uint32_t changed; /**< 1: it has been moved or painted since the session was opened, or inserted */
} pp_row;
/** Where the present points come from: entry i is of row i of pp_session_cloud(). `capacity` must be at least their
 * number, `count`; with `capacity` 0 the call only returns that. PP_ERROR_STATE if the points move by themselves. */
PP_API pp_status pp_session_rows(pp_session session, pp_row* rows, uint64_t capacity, uint64_t* count);

/** A position on the surface that the hands feel. */
typedef struct pp_surface_point {
  double position[3]; /**< model units */
  double normal[3];   /**< unit length, outward */
  double distance;    /**< from the position that was asked for, or along the ray; model units */
  uint64_t row;       /**< point of the cloud next to it, as in pp_row */
  uint32_t cloud;     /**< cloud of that point, as in pp_row */
  uint8_t found;      /**< 0: there is no surface within max_distance, and all else is zero */
  uint8_t behind;     /**< 1: asked for from behind the surface, as from inside a closed one */
  uint16_t reserved;  /**< not used */
} pp_surface_point;

/** For each of `count` positions, the nearest one on the surface of the present points, at most `max_distance` away
 * (model units; may be infinite). The surface is the one that pp_touch() feels, on any back end; it is computed in
 * double precision on the CPU, by the threads of the session. The first call builds an index of all points; edits that
 * have been taken in (pp_session_apply_edits()) change it, and the call takes in those so far. Next to an open rim the
 * position lies on the rim. `positions`: x y z, PP_FLOAT32 or PP_FLOAT64. A call that looks: another thread may touch
 * if there is a budget. PP_ERROR_ARGUMENT names the first row that is not finite, PP_ERROR_STATE for water, sand and
 * points that another program has. */
PP_API pp_status pp_session_nearest(pp_session session, const pp_rows* positions, uint64_t count, double max_distance,
                                    pp_surface_point* found);
/** For each of `count` positions, the nearest of the present points itself, with its normal; `behind` is 0. Much faster
 * than pp_session_nearest(), which finds the surface between the points, and otherwise as it. */
PP_API pp_status pp_session_nearest_points(pp_session session, const pp_rows* positions, uint64_t count,
                                           double max_distance, pp_surface_point* found);
/** For each of `count` rays, the first position of the surface on it, at most `max_distance` from its origin (model
 * units; may be infinite). A ray that begins behind the surface hits it from there. Directions have any length but 0;
 * PP_ERROR_ARGUMENT names the first row that is 0 or not finite. A ray that is nowhere deeper in the surface than a
 * sixteenth of the support radius may pass it. Otherwise as pp_session_nearest(). */
PP_API pp_status pp_session_raycast(pp_session session, const pp_rows* origins, const pp_rows* directions,
                                    uint64_t count, double max_distance, pp_surface_point* found);

/** @} */

#endif
