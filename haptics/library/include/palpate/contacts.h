/** @file
 * palpate's C interface: notification of the beginning and the end of each contact. palpate.h includes this. */
#ifndef PALPATE_CONTACTS_H
#define PALPATE_CONTACTS_H
#ifndef PALPATE_H
#error "include <palpate/palpate.h>, which includes this header"
#endif

/** @defgroup contacts Beginning and end of contacts
 * @{ */

/** Beginning or end of a contact. */
typedef struct pp_contact_event {
  double t_s;        /**< time of the tick at which it began or ended, s */
  double proxy[3];   /**< position on the surface, model units; at the end that of the last tick in contact */
  double normal[3];  /**< unit length, outward; likewise */
  double force_N[3]; /**< force on the hand, N; likewise */
  uint32_t hand;     /**< index of the hand, from 0 */
  uint32_t begins;   /**< 1: the contact begins; 0: it ends */
} pp_contact_event;

/** Receives the beginning and the end of each contact. Called on the thread of the call that delivers it
 * (pp_session_on_contact()). It must return at once and must not throw; calls on sessions, matter and servers from
 * within it give PP_ERROR_STATE. */
typedef void (*pp_contact_function)(void* user, const pp_contact_event* event);

/** Sets the function that is called at the beginning and the end of each contact; null: none. Each beginning is
 * followed by an end, unless the session is closed or the function replaced meanwhile; a fault ends the contact.
 *
 * With pp_touch() it is called before that call returns, on the thread that ticks. By path it is called once the path
 * has been followed, on the calling thread, for all its ticks in order, and a contact ends with the path. Live, the
 * servo thread never calls it: pp_live_read_ticks() does, on its own thread, for the ticks that it returns, so a
 * program that reads thirty times a second hears of a contact within 33 ms. Ticks that were dropped because they were
 * not read in time have no events. The contact of a live session that has ended ends once all its ticks have been read.
 * Any other call that ends a contact, such as pp_session_undo(), tells its end.
 *
 * PP_ERROR_STATE while the session is live. */
PP_API pp_status pp_session_on_contact(pp_session session, pp_contact_function function, void* user);

/** @} */

#endif
