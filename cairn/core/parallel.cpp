// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <atomic>
#include <cairn/core/parallel.hpp>
#include <thread>
#include <utility>

#if CAIRN_WITH_TBB
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>
#endif

// ThreadSanitizer does not see how oneTBB's library, built without it, passes work between threads, so it is
// annotated here. Reads of a closure before that are excluded; for oneTBB's headers see tests/tsan.supp.
#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
#define CAIRN_NOT_WATCHED __attribute__((no_sanitize("thread"), noinline))
#else
#define CAIRN_NOT_WATCHED
#endif

namespace cairn {

#if CAIRN_WITH_TBB
namespace {

/// A happens-before edge from give() to take(), for ThreadSanitizer only.
class HandOver {
 public:
#if defined(__SANITIZE_THREAD__)
  void give() {
    __tsan_release(this);
  }
  void take() {
    __tsan_acquire(this);
  }
#else
  void give() {}
  void take() {}
#endif
};

// At the end of a scope, also after an exception.
struct GiveLast {
  HandOver& over;
  ~GiveLast() { over.give(); }
};
struct TakeLast {
  HandOver& over;
  ~TakeLast() { over.take(); }
};

}  // namespace
#endif

class Workers {
 public:
  explicit Workers(int threads)
      : threads_(threads)
#if CAIRN_WITH_TBB
        ,
        limit_(oneapi::tbb::global_control::max_allowed_parallelism,
               std::max(static_cast<std::size_t>(threads),
                        oneapi::tbb::global_control::active_value(
                            oneapi::tbb::global_control::max_allowed_parallelism))),
        arena_(threads)
#endif
  {
  }
  [[nodiscard]] int threads() const {
    return threads_;
  }

  void run(int count, int grain, const std::function<void(int, int)>& body) {
#if CAIRN_WITH_TBB
    // threads × 4 equal parts: enough to balance the load, few enough to keep the set-up per range cheap.
    const int part = std::max(grain, (count + threads_ * 4 - 1) / (threads_ * 4));
    const int parts = (count + part - 1) / part;
    // Isolated: a thread that waits for the last part must not start side work, which takes much longer.
    HandOver begun;
    HandOver done;
    const TakeLast last{done};
    const auto do_part = [&](int i) {
      const GiveLast part_last{done};
      body(i * part, std::min(count, (i + 1) * part));
    };
    begun.give();
    arena_.execute([&]() CAIRN_NOT_WATCHED {
      oneapi::tbb::this_task_arena::isolate([&]() CAIRN_NOT_WATCHED {
        oneapi::tbb::parallel_for(
            0, parts,
            [&](int i) CAIRN_NOT_WATCHED {
              begun.take();
              do_part(i);
            },
            oneapi::tbb::simple_partitioner{});
      });
    });
#else
    body(0, count);
    (void)grain;
#endif
  }

#if CAIRN_WITH_TBB
  [[nodiscard]] oneapi::tbb::task_arena& arena() {
    return arena_;
  }
#endif

 private:
  int threads_;
#if CAIRN_WITH_TBB
  // oneTBB would print a warning and refuse to use more threads than there are processors. The limit is only
  // ever raised.
  oneapi::tbb::global_control limit_;
  oneapi::tbb::task_arena arena_;
#endif
};

Exec Exec::with_threads(int threads, Target target) {
  Exec exec;
  exec.target = target;
  if (threads <= 0) threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  if (threads > 1) exec.workers = std::make_shared<Workers>(threads);
  return exec;
}

int Exec::threads() const {
  return workers ? workers->threads() : 1;
}

Exec Exec::beside() const {
  return {target, workers ? pool.beside() : pool, {}, workers, device};
}

void parallel_for(const Exec& exec, int count, int grain, const std::function<void(int, int)>& body) {
  if (count <= 0) return;
  if (!exec.workers || count <= grain) {
    body(0, count);
  } else {
    exec.workers->run(count, grain, body);
  }
}

#if CAIRN_WITH_TBB
class SideWork::Running {
 public:
  Running(std::shared_ptr<Workers> workers, std::function<void()> work)
      : workers_(std::move(workers)), work_(std::move(work)) {
    begun_.give();
    workers_->arena().execute([this]() CAIRN_NOT_WATCHED {
      group_.run([this]() CAIRN_NOT_WATCHED {
        begun_.take();
        begin();
      });
    });
  }
  void wait() {
    const TakeLast last{done_};
    workers_->arena().execute([this]() CAIRN_NOT_WATCHED { group_.wait(); });
  }
  /// Does not cancel the group: that would also end the loops inside the work, which would then continue on
  /// incomplete results.
  void give_up() {
    given_up_ = true;
    wait();
  }

 private:
  void begin() {
    const GiveLast last{done_};
    if (!given_up_) work_();
  }

  std::shared_ptr<Workers> workers_;
  std::function<void()> work_;
  std::atomic<bool> given_up_ = false;
  HandOver begun_;
  HandOver done_;
  oneapi::tbb::task_group group_;
};

SideWork::SideWork(const Exec& exec, std::function<void()> work) {
  if (exec.workers) {
    running_ = std::make_unique<Running>(exec.workers, std::move(work));
  } else {
    work_ = std::move(work);
  }
}
#else
class SideWork::Running {
 public:
  void wait() {}
  void give_up() {}
};

SideWork::SideWork(const Exec&, std::function<void()> work) : work_(std::move(work)) {}
#endif

SideWork::~SideWork() {
  if (!running_) return;
  try {
    running_->give_up();
  } catch (...) {  // the result is no longer needed
  }
}

void SideWork::wait() {
  if (running_) {
    const std::unique_ptr<Running> running = std::move(running_);
    running->wait();
  } else {
    work_();
  }
}

}  // namespace cairn
