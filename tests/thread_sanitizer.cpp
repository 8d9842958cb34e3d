// Options of ThreadSanitizer, for programs of tests that it is built into.
#ifdef __SANITIZE_THREAD__
#define PALPATE_TO_SANITIZER extern "C" __attribute__((visibility("default"))) const char*
// The system's DDS library is not instrumented: what it frees by a count of references looks like a race.
PALPATE_TO_SANITIZER __tsan_default_suppressions() { return "race:libddsc.so\n"; }
// Cases fork, and their children start threads.
PALPATE_TO_SANITIZER __tsan_default_options() { return "die_after_fork=0"; }
#endif
