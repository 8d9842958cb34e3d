/** @file
 * palpate's C interface: touching and sculpting in a session. palpate.h includes this. */
#ifndef PALPATE_TOUCH_H
#define PALPATE_TOUCH_H
#ifndef PALPATE_H
#error "include <palpate/palpate.h>, which includes this header"
#endif

#include <palpate/sessions.h>

/** @defgroup touch Touching and sculpting: paths, single ticks, brushes, undo
 * @{ */

/** Path of a hand, model units. With 3 columns x y z: one row for each tick. With 4 columns, seconds first: times
 * increase from 0 or later, the hand moves on straight lines between the rows, and the last tick is the one
 * nearest to the time of the last row. */
typedef struct pp_path {
  uint32_t size;     /**< bytes of this struct */
  int32_t type;      /**< pp_number: PP_FLOAT32 or PP_FLOAT64 */
  uint32_t columns;  /**< 3 or 4 */
  uint32_t reserved; /**< not used */
  uint64_t rows;     /**< number of rows, at least 1 */
  const void* data;  /**< the numbers of the first row */
  int64_t stride;    /**< bytes from one row to the next; 0: rows are contiguous */
} pp_path;
PP_OPTIONS(path)
/** Number of ticks of a path at the session's rate. With several hands, the longest of their paths counts.
 * PP_ERROR_ARGUMENT names the first invalid row. */
PP_API pp_status pp_path_ticks(pp_session session, const pp_path* path, uint64_t* count);

/** Follows the path in virtual time, as fast as possible, and only feels: the same path gives the same ticks.
 * `capacity` must be at least the number that pp_path_ticks() gives. PP_ERROR_GPU if ticks had no valid answer, and
 * PP_ERROR_STOPPED: `count` ticks are written, and those without an answer have valid 0 and no force. */
PP_API pp_status pp_session_touch(pp_session session, const pp_path* path, pp_tick* ticks, uint64_t capacity,
                                  uint64_t* count);

/** One tick, for a servo loop of the program, such as one at 1 kHz: takes a pose with its time and returns contact and
 * force. Commands between two ticks (brush, contact, undo, redo, record, settle, copies of the points) leave contact
 * and force as they are. A path, a live session and pp_touch_lift() end the contact. The first pose after them, and of
 * a session, may be inside: the hand then touches nothing until it has left the surface, so that no sudden force hits
 * it. That first call may take long: make it before the device has a force. Later ones allocate nothing unless points
 * are edited, take no lock that another thread holds for longer than the copy of a pointer, and with
 * pp_session_options.budget_us wait for no query beyond it: an answer that is late is held (pp_contact). Times increase
 * by the duration of a tick; the first one, also after pp_touch_lift(), is free. Returns PP_OK even if contact->valid
 * is 0; with any other status there is no force. PP_ERROR_ARGUMENT for numbers that are not finite and for a time that
 * is not later than that of the pose before; that pose then counts as not given. */
PP_API pp_status pp_touch(pp_session session, const pp_pose* pose, pp_contact* contact);
/** One tick for all hands of a session: `poses`, `contacts`, `orientations` and `torques_mNm` have an entry for each of
 * the `hands` hands. The time of the first pose is used for all. `orientations`: rotation of each hand's tool, unit
 * quaternions w x y z; null: no rotation. `torques_mNm`: torques about the HIP, of tools and of balls in matter, 3 for
 * each hand; null: not wanted. PP_ERROR_ARGUMENT unless each hand of the session has a pose and each rotation is a unit
 * quaternion, PP_ERROR_STATE while the session is live. */
PP_API pp_status pp_touch_hands(pp_session session, const pp_pose* poses, const double* orientations, uint32_t hands,
                                pp_contact* contacts, double* torques_mNm);
/** Notifies the session that all hands were lifted: the next poses begin new contacts elsewhere. */
PP_API pp_status pp_touch_lift(pp_session session);

/** A brush changes the points within its reach while the hand is deeper than yield_depth_mm. With `resample` all but
 * carve move a point only as far as it has seen; without, a deep push moves one side of a thin part through another. */
typedef struct pp_brush {
  uint32_t size;         /**< bytes of this struct */
  uint32_t falloff;      /**< falloff towards the rim: (1 - r^2)^falloff; 0 to 16; default 1 */
  const char* kind;      /**< push carve inflate smooth grab paint flatten; null: push */
  double yield_depth_mm; /**< depth of the hand from which the surface yields, mm; default 0.5 */
  double push_rate;      /**< push: share of the distance to its target per tick, 0 to 1; default 0.1 */
  double radius_mm;      /**< reach of the brush, mm in the hand; default 6 */
  double strength;       /**< other brushes: share of the full effect applied in one tick, 0 to 1; default 0.5 */
  uint8_t color[4];      /**< paint: red green blue; the fourth is not used */
  /** 1: points are inserted where the surface is stretched, and merged where it is crowded; default 1 */
  uint32_t resample;
  /** Each edit is also made mirrored: "x", "y" or "z", at the plane across that axis through the middle of the model,
   * or "PX,PY,PZ,NX,NY,NZ", a position on the plane and its normal in the model's coordinates; null or "": it is not.
   * The force is that of the hand alone. */
  const char* symmetry;
  /** inflate, 1: a stroke that passes over points again, or rests, raises them on; 0: by as much as the hand presses;
   * default 0. Push, carve, flatten and grab follow the hand, smooth and paint always accumulate. */
  uint32_t accumulate;
  uint32_t reserved; /**< not used */
} pp_brush;
PP_OPTIONS(brush)
/** Sets the brush of pp_touch(), and of the present or next live hand; null: they only feel. The first brush of a
 * session rebuilds the index, so that points can be inserted and removed: PP_ERROR_STATE for that one while the session
 * is live. PP_ERROR_ARGUMENT, with the reason, if the model does not allow that brush, or if a setting is out of
 * bounds. */
PP_API pp_status pp_session_set_brush(pp_session session, const pp_brush* brush);
/** Changes surface and force. `radius_mm` must be 0 or as the session was opened, or else the call returns
 * PP_ERROR_ARGUMENT. */
PP_API pp_status pp_session_set_contact(pp_session session, const pp_contact_options* contact);
/** pp_session_touch() with a brush for this path only. A stroke consists of all edits in one contact, with gaps of up
 * to 0.3 s. Errors as for pp_session_touch() and pp_session_set_brush(). */
PP_API pp_status pp_session_stroke(pp_session session, const pp_path* path, const pp_brush* brush, pp_tick* ticks,
                                   uint64_t capacity, uint64_t* count);
/** pp_session_touch() or pp_session_stroke() for all hands of a session: `paths` has a path for each of the `hands`
 * hands, and a hand stays where its path ends. `capacity` and `count` are numbers of rows: those of all hands in one
 * tick, in order, then those of the next tick. `brush`: of the first hand; null: it only feels. `torques_mNm`: torques
 * of tools about the HIP, 3 for each row; null: not wanted. PP_ERROR_ARGUMENT unless each hand of the session has a
 * path; otherwise as for pp_session_stroke(). */
PP_API pp_status pp_session_touch_hands(pp_session session, const pp_path* const* paths, uint32_t hands,
                                        const pp_brush* brush, pp_tick* ticks, double* torques_mNm, uint64_t capacity,
                                        uint64_t* count);
/** Undoes the last strokes; each point is restored to the last bit. `done`: number of strokes undone, fewer than
 * `strokes` if there are no more; may be null. PP_ERROR_ARGUMENT, with the reason, if the model does not allow it;
 * PP_ERROR_NETWORK, with `done`, if the server of a joined session has not confirmed it within
 * pp_join_options.timeout_s. */
PP_API pp_status pp_session_undo(pp_session session, uint64_t strokes, uint64_t* done);
/** Takes the stroke in progress back, each point to the last bit, as if it had never been made: it cannot be redone,
 * and the hand makes no other before it has left the surface. Between two calls of pp_touch(), and of a live hand;
 * contact and force go on. `cancelled`: 1, or 0 where no stroke is in progress; may be null. Otherwise as
 * pp_session_undo(), and PP_ERROR_FAILED for a stroke larger than pp_session_options.undo_memory_MiB, which stays. */
PP_API pp_status pp_session_cancel_stroke(pp_session session, uint32_t* cancelled);
/** Redoes the strokes undone last, as pp_session_undo() undoes them. */
PP_API pp_status pp_session_redo(pp_session session, uint64_t strokes, uint64_t* done);
/** What a mask of the points means. */
typedef enum pp_mask {
  PP_MASK_SELECTED = 0, /**< commands act on them */
  PP_MASK_HIDDEN = 1,   /**< neither drawn nor felt; saved as all others are */
  PP_MASK_LOCKED = 2,   /**< felt, and no brush changes them */
  PP_MASK_WITHIN = 3,   /**< if there are any, brushes change no others */
  /** How far points are locked, 0 to 255: brushes move a point by the rest of what they would move it; paint works at
   * the rest of its strength, and carve cuts points up to 127. 0 and 255 alone are PP_MASK_LOCKED; other weights are
   * saved with the points, as the property "lock", by which a file is locked when it is opened. */
  PP_MASK_LOCK_WEIGHTS = 4
} pp_mask;
/** Sets a mask of the present points, until it is set again or undone as a stroke is; new points get the masks of those
 * that they come from. `mask`: a byte for each of the `points` points, in the order of pp_session_cloud(); 0: the point
 * is not in it. The first mask of a session rebuilds the index as the first brush does: PP_ERROR_STATE for that one
 * while the session is live. PP_ERROR_ARGUMENT for another number of points, and, with the reason, if the model does
 * not allow it. */
PP_API pp_status pp_session_set_mask(pp_session session, pp_mask which, const uint8_t* mask, uint64_t points);
/** Removes the points of a mask, as one stroke that can be undone. Mask and errors as for pp_session_set_mask(). */
PP_API pp_status pp_session_remove_points(pp_session session, const uint8_t* mask, uint64_t points);
/** Moves the points of a mask, as one stroke that can be undone: to `offset` + `scale` * (`rotation` * position), in
 * model units and the coordinates of pp_session_cloud(); normals rotate. `rotation`: a unit quaternion w, x, y, z, or
 * null for none; `scale`: positive; `offset`: x, y, z, or null for none. Mask and errors as for
 * pp_session_set_mask(); PP_ERROR_ARGUMENT also for numbers that are not finite. */
PP_API pp_status pp_session_move_points(pp_session session, const uint8_t* mask, uint64_t points,
                                        const double* rotation, double scale, const double* offset);
/** Copies a mask: 1 for points in it, else 0. Order and errors as for pp_session_set_mask(). */
PP_API pp_status pp_session_mask(pp_session session, pp_mask which, uint8_t* mask, uint64_t points);
/** Softens the rims of what is locked, outwards: each weight (PP_MASK_LOCK_WEIGHTS) below 255 becomes the mean of the
 * weights of the points nearer than `radius_mm`, mm in the hand, which count less the farther they are. Undone as a
 * stroke. Errors as for pp_session_set_mask(), and PP_ERROR_ARGUMENT for a radius that is not positive. */
PP_API pp_status pp_session_soften_lock(pp_session session, double radius_mm);
/** Makes a layer of strokes of that name, or opens one again at strength 1: all strokes become part of it, until
 * another one is opened, its strength slides, it is hidden or merged, or `name` is null, which ends that. The first
 * layer of a session rebuilds the index as the first brush does: PP_ERROR_STATE for that one while the session is live.
 * PP_ERROR_ARGUMENT, with the reason, if the model does not allow it. This and the calls below are undone as a stroke
 * is. */
PP_API pp_status pp_session_open_layer(pp_session session, const char* name);
/** Gives the strokes of a layer another strength, from -1 to 2: with 0 the points are as before them, with 1 as after
 * them, both to the last bit, and between and beyond on a closed surface. Deep cuts or pulls have a smaller range,
 * beyond which it is refused (PP_ERROR_FAILED, with the range). Points that they cut away are gone from 0.5 on, points
 * that they inserted at 0. What other strokes have done since goes along. Locked points stay as they are, and points
 * that are locked in part go the rest of their way. `continues`: 1 adds to the slide before, as one change to be
 * undone, while a user drags; else 0. PP_ERROR_ARGUMENT where there is no layer of that name. */
PP_API pp_status pp_session_slide_layer(pp_session session, const char* name, double strength, uint32_t continues);
/** Hides a layer of strokes, as with strength 0, or shows it again at its strength. Errors as for
 * pp_session_slide_layer(). */
PP_API pp_status pp_session_hide_layer(pp_session session, const char* name, uint32_t hidden);
/** Makes a layer of strokes part of the model, as strong as it is; its name can be given again. Errors as for
 * pp_session_slide_layer(). */
PP_API pp_status pp_session_merge_layer(pp_session session, const char* name);
/** How a layer of strokes is set, and the number of points that its strokes have changed; each may be null. Errors as
 * for pp_session_slide_layer(). */
PP_API pp_status pp_session_layer(pp_session session, const char* name, double* strength, uint32_t* hidden,
                                  uint64_t* points);
/** Takes in the edits that pp_touch() with a budget, or a live hand, has made. Call it some thirty times a second:
 * edits are dropped once too many are pending. Pictures and pp_live_read_ticks() do it, too. In a joined session this
 * also sends the edits to the other programs; PP_ERROR_NETWORK once this hand's part in it has ended. */
PP_API pp_status pp_session_apply_edits(pp_session session);
/** Copies the present points into a new cloud; after a failure, such as a lost GPU or missing memory, the last known
 * ones, with a warning to the log. */
PP_API pp_status pp_session_cloud(pp_session session, pp_cloud* cloud);

/** @} */

#endif
