#pragma once

/// Independent pieces of work on all processors.

#include <cstddef>
#include <functional>

namespace faceta {

/// Calls task(0) ... task(count - 1), begun in this order, on whichever thread is free. Returns
/// when all are done; what they wrote is then visible to the caller.
void run_in_order(size_t count, const std::function<void(size_t)>& task);

} // namespace faceta
