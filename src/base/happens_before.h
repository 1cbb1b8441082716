#pragma once

#include "base/sanitizers.h"

/// Tells ThreadSanitizer of an order that it cannot see: TBB's library is not instrumented, so that
/// what its threads have written looks like a race to the thread that waited for them. Everything
/// before publish(token) in one thread happens before everything after receive(token), the same
/// address, in another. The address of no atomic, whose stores would make it forget. Neither
/// synchronises anything; in other builds they are nothing.

#if defined(FACETA_THREAD_SANITIZER)
extern "C" void __tsan_acquire(void* address); // NOLINT(bugprone-reserved-identifier): its name
extern "C" void __tsan_release(void* address); // NOLINT(bugprone-reserved-identifier): its name
#endif

namespace faceta::happens_before {

inline void publish([[maybe_unused]] const void* token) {
#if defined(FACETA_THREAD_SANITIZER)
  __tsan_release(const_cast<void*>(token));
#endif
}

inline void receive([[maybe_unused]] const void* token) {
#if defined(FACETA_THREAD_SANITIZER)
  __tsan_acquire(const_cast<void*>(token));
#endif
}

} // namespace faceta::happens_before
