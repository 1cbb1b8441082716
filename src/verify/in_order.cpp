#include "verify/in_order.h"

#include "base/happens_before.h"

#include <atomic>
#include <tbb/parallel_for.h>

namespace faceta {

void run_in_order(size_t count, const std::function<void(size_t)>& task) {
  std::atomic<size_t> next{0};
  tbb::parallel_for(
      tbb::blocked_range<size_t>(0, count, 1),
      [&](const tbb::blocked_range<size_t>& range) {
        for (size_t i = range.begin(); i != range.end(); ++i)
          task(next++);
        happens_before::publish(&task);
      },
      tbb::simple_partitioner());
  happens_before::receive(&task);
}

} // namespace faceta
