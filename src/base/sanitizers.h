#pragma once

// Which sanitizer this is compiled for: FACETA_THREAD_SANITIZER, and FACETA_SANITIZED for that or
// AddressSanitizer.

#if defined(__SANITIZE_THREAD__)
#define FACETA_THREAD_SANITIZER
#elif defined(__SANITIZE_ADDRESS__)
#define FACETA_SANITIZED
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define FACETA_THREAD_SANITIZER
#elif __has_feature(address_sanitizer)
#define FACETA_SANITIZED
#endif
#endif

#ifdef FACETA_THREAD_SANITIZER
#define FACETA_SANITIZED
#endif
