// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <bit>
#include <cairn/core/random.hpp>
#include <cairn/core/statistics.hpp>
#include <cairn/device/careful_device.hpp>
#include <cstddef>
#include <utility>

namespace cairn::device {
namespace {

constexpr std::size_t kRacePairs = 5;  // of each side

/// Engines that were lost at work: a driver may still use their memory, so they are never destroyed, not even at exit.
void keep_at_work(std::unique_ptr<Engine> engine) {
  static auto* const all = new std::vector<std::unique_ptr<Engine>>();
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  all->push_back(std::move(engine));
}

template <class T>
bool has_same_bits(const Image<T>& a, const Image<T>& b) {
  using Bits = std::array<std::byte, sizeof(T)>;
  if (a.size() != b.size()) return false;
  for (int y = 0; y < a.height(); ++y) {
    if (!std::equal(a.row(y), a.row(y) + a.width(), b.row(y),
                    [](T x, T z) { return std::bit_cast<Bits>(x) == std::bit_cast<Bits>(z); }))
      return false;
  }
  return true;
}

bool has_same_bits(const Matches& a, const Matches& b) {
  return has_same_bits(a.best, b.best) && has_same_bits(a.best_right, b.best_right) &&
         has_same_bits(a.cost, b.cost) && has_same_bits(a.runner_up, b.runner_up) &&
         has_same_bits(a.mean_cost, b.mean_cost) && has_same_bits(a.cost_before, b.cost_before) &&
         has_same_bits(a.cost_after, b.cost_after);
}

/// Noise, shifted by 5 px, with a flat patch: winners, ties and pixels without a match.
void draw_pair(Image<Gray>& left, Image<Gray>& right) {
  Random random;
  for (int y = 0; y < left.height(); ++y) {
    for (int x = 0; x < left.width(); ++x) {
      const bool is_flat = x / 16 == 1 && y / 16 == 1;
      left(x, y) = is_flat ? Gray{90} : static_cast<Gray>(random.below(256));
    }
    for (int x = 0; x < left.width(); ++x) right(x, y) = left(std::min(x + 5, left.width() - 1), y);
  }
}

/// It computes something else than the processor.
struct Wrong : Unfit {
  using Unfit::Unfit;
};

/// Throws Wrong, or like the engine.
void compare_with_processor(Engine& engine, int num_disparities) {
  const Size size{61, 47};  // leaves spare teams in rows and columns
  Image<Gray> left(size, 0, {}), right(size, 0, {});
  draw_pair(left, right);
  const StereoPair pair = StereoPair::from(left, right);
  const MatchConfig config{.method = MatchMethod::semi_global, .num_disparities = num_disparities};
  engine.submit(pair, config, {});
  if (!has_same_bits(engine.finish({}), match_semi_global(pair, config, {}, {}))) {
    throw Wrong(engine.full_name() + " does not compute what the processor computes (" +
                engine.variant(num_disparities) + "); please report it");
  }
}

/// An engine whose kernels of the usual range are right.
std::unique_ptr<Engine> tested(std::unique_ptr<Engine> engine) {
  try {
    compare_with_processor(*engine, MatchConfig{}.num_disparities);
  } catch (const Lost& lost) {
    if (lost.is_busy) keep_at_work(std::move(engine));
    throw;
  }
  return engine;
}

std::string in_ms(double ms) {
  const auto tenths = static_cast<long>(10 * ms + 0.5);
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " ms";
}

template <class Work>
double wall_ms(const Work& work) {
  const auto begin = CarefulDevice::Clock::now();
  work();
  return std::chrono::duration<double, std::milli>(CarefulDevice::Clock::now() - begin).count();
}

bool is_same(const MatchConfig& a, const MatchConfig& b) {
  return a.min_disparity == b.min_disparity && a.num_disparities == b.num_disparities && a.maps == b.maps;
}

bool is_same(const SemiGlobalConfig& a, const SemiGlobalConfig& b) {
  return a.penalty_small == b.penalty_small && a.penalty_large == b.penalty_large &&
         a.penalty_edge == b.penalty_edge;
}

StereoPair without_colour(const StereoPair& pair) {
  return StereoPair::from(pair.left(), pair.right());
}

}  // namespace

CarefulDevice::Task::Task(const StereoPair& pair, const MatchConfig& match,
                          const SemiGlobalConfig& semi_global, const Pool& pool)
    : images(without_colour(pair), pool), config(match), penalties(semi_global) {}

bool CarefulDevice::Task::equals(const StereoPair& pair, const MatchConfig& match,
                                 const SemiGlobalConfig& semi_global) const {
  return is_same(config, match) && is_same(penalties, semi_global) && images.equals(without_colour(pair));
}

CarefulDevice::Search CarefulDevice::search_of(const StereoPair& pair, const MatchConfig& config) {
  return {pair.size().width, pair.size().height, config.num_disparities};
}

CarefulDevice::CarefulDevice(Open open, Trust trust, Notice notice, std::string wanted)
    : open_(std::move(open)), trust_(trust), notice_(std::move(notice)) {
  report_.wanted = std::move(wanted);
  if (trust_.must_be_faster) {
    race_.emplace();
    start_opening();
    return;
  }
  take(tested(open_()));
}

CarefulDevice::~CarefulDevice() {
  if (!engine_ || !submitted_) return;
  try {
    static_cast<void>(engine_->finish({}));
  } catch (const Lost& lost) {
    if (lost.is_busy) keep_at_work(std::move(engine_));
  } catch (const std::bad_alloc&) {
    keep_at_work(std::move(engine_));
  }
}

bool CarefulDevice::takes_early(const MatchConfig& config) const {
  return config.method == MatchMethod::semi_global && is_taking_;
}

void CarefulDevice::begin(const StereoPair& pair, const MatchConfig& config,
                          const SemiGlobalConfig& penalties) {
  if (!takes_early(config)) return;
  {
    const std::lock_guard queue_lock(queue_mutex_);
    if (waiting_) return;
    waiting_.emplace(pair, config, penalties, pool_);
  }
  // While the engine works, the thread that waits for it submits this one.
  const std::unique_lock engine_lock(engine_mutex_, std::try_to_lock);
  if (engine_lock.owns_lock()) submit_waiting();
}

std::optional<Matches> CarefulDevice::match(const StereoPair& pair, const MatchConfig& config,
                                            const SemiGlobalConfig& penalties, const Exec& exec) {
  std::optional<Matches> found;
  if (config.method == MatchMethod::semi_global) {
    found = match_or_leave(pair, config, penalties, exec);
  } else {
    notify("devices match semi-globally, not by windows (match.method=window)");
  }
  if (!found) count(false);
  tell();
  return found;
}

std::optional<Matches> CarefulDevice::match_or_leave(const StereoPair& pair, const MatchConfig& config,
                                                     const SemiGlobalConfig& penalties, const Exec& exec) {
  std::optional<Matches> found;
  std::unique_lock engine_lock(engine_mutex_);
  if (!is_ready() || unfit_.contains(search_of(pair, config))) return found;
  if (race_ && race_->device_ms.size() > race_->processor_ms.size()) {
    engine_lock.unlock();
    const double ms = wall_ms([&] { found = match_semi_global(pair, config, penalties, exec); });
    engine_lock.lock();
    count(false);
    if (race_) race_->processor_ms.push_back(ms);
    decide_race();
    return found;
  }
  try {
    const double ms = wall_ms([&] { found = on_device(pair, config, penalties, exec); });
    if (race_) race_->device_ms.push_back(ms);
  } catch (const Wrong& wrong) {
    give_up(wrong.what());
  } catch (const Unfit& unfit) {
    unfit_.insert(search_of(pair, config));
    notify(unfit.what());
  } catch (const Lost& lost) {
    lose(lost);
  }
  submit_waiting();
  return found;
}

DeviceReport CarefulDevice::report() const {
  const std::lock_guard lock(report_mutex_);
  return report_;
}

void CarefulDevice::start_opening() {
  opening_ = std::async(std::launch::async, [this] { return tested(open_()); });
}

void CarefulDevice::take(std::unique_ptr<Engine> tested) {
  engine_ = std::move(tested);
  trusted_ = {engine_->variant(MatchConfig{}.num_disparities)};
  unfit_.clear();
  is_taking_ = !race_;
  const std::lock_guard lock(report_mutex_);
  report_.name = engine_->name();
}

/// Takes the engine that was opened beside the frames, and begins to open a lost one again.
bool CarefulDevice::is_ready() {
  using namespace std::chrono_literals;
  if (engine_) return true;
  if (is_given_up_) return false;
  if (!opening_.valid() && Clock::now() >= lost_at_ + trust_.reopen_after) start_opening();
  if (!opening_.valid() || opening_.wait_for(0s) != std::future_status::ready) return false;
  try {
    take(opening_.get());
  } catch (const Lost& lost) {
    lose(lost);
  } catch (const std::runtime_error& failed) {
    give_up(failed.what());
  }
  return engine_ != nullptr;
}

/// Compares a kind of kernels with the processor, once.
void CarefulDevice::be_sure_of(const MatchConfig& config) {
  const std::string variant = engine_->variant(config.num_disparities);
  if (trusted_.contains(variant)) return;
  compare_with_processor(*engine_, config.num_disparities);
  trusted_.insert(variant);
}

/// If the engine is free, and knows this kind of pairs: match() meets the faults, and says so.
void CarefulDevice::submit_waiting() {
  if (!engine_ || submitted_ || race_) return;
  std::optional<Task> next;
  {
    const std::lock_guard queue_lock(queue_mutex_);
    next.swap(waiting_);
  }
  if (!next) return;
  const StereoPair pair = next->images.pair();
  try {
    if (unfit_.contains(search_of(pair, next->config))) return;
    if (!trusted_.contains(engine_->variant(next->config.num_disparities))) return;
    engine_->submit(pair, next->config, next->penalties);
    submitted_ = std::move(next);
  } catch (const Unfit&) {
    unfit_.insert(search_of(pair, next->config));
  } catch (const Lost& lost) {
    lose(lost);
  }
}

Matches CarefulDevice::on_device(const StereoPair& pair, const MatchConfig& config,
                                 const SemiGlobalConfig& penalties, const Exec& exec) {
  const auto is_this = [&](const Task& task) { return task.equals(pair, config, penalties); };
  std::optional<Matches> found;
  std::vector<DeviceKernel> work;
  if (done_ && is_this(done_->task)) {
    found = std::move(done_->matches);
    work = std::move(done_->work);
    done_.reset();
  }
  if (!found && submitted_ && !is_this(*submitted_)) {
    // Of a loop that begins the next pair before the first one: its turn comes.
    Task task = *std::exchange(submitted_, std::nullopt);
    done_.reset();
    Matches matches = engine_->finish(exec);
    done_ = Done{std::move(task), std::move(matches), engine_->work()};
  }
  if (!found) {
    if (!std::exchange(submitted_, std::nullopt)) {
      be_sure_of(config);
      engine_->submit(pair, config, penalties);
    }
    found = engine_->finish(exec);
    work = engine_->work();
  }
  count(true, work);
  return std::move(*found);
}

void CarefulDevice::decide_race() {
  if (!race_ || race_->processor_ms.size() < kRacePairs) return;
  const double device_ms = percentile(race_->device_ms, 0.5),
               processor_ms = percentile(race_->processor_ms, 0.5);
  race_.reset();
  is_taking_ = engine_ != nullptr;
  if (engine_ && device_ms >= processor_ms) {
    give_up(engine_->name() + " needs " + in_ms(device_ms) + " for a pair, the processor " +
            in_ms(processor_ms));
  }
}

void CarefulDevice::lose(const Lost& lost) {
  submitted_.reset();
  if (lost.is_busy && engine_) keep_at_work(std::move(engine_));
  engine_.reset();
  is_taking_ = false;
  lost_at_ = Clock::now();
  if (++losses_ > trust_.most_reopenings) {
    give_up(lost.what());
  } else {
    notify(std::string(lost.what()) + "; it is opened again after " +
           std::to_string(trust_.reopen_after.count()) + " s");
  }
}

void CarefulDevice::give_up(const std::string& why) {
  submitted_.reset();
  done_.reset();
  engine_.reset();
  is_given_up_ = true;
  is_taking_ = false;
  notify(why + "; it is not used any more");
}

void CarefulDevice::count(bool on_device, const std::vector<DeviceKernel>& work) {
  const std::lock_guard lock(report_mutex_);
  ++(on_device ? report_.on_device : report_.on_processor);
  report_.kernels.resize(std::max(report_.kernels.size(), work.size()));
  for (std::size_t i = 0; i < work.size(); ++i) {
    DeviceKernel& sum = report_.kernels[i];
    sum.name = work[i].name;
    sum.ms += work[i].ms;
    sum.bytes += work[i].bytes;
    sum.dispatches += work[i].dispatches;
  }
  if (on_device && engine_) report_.memory_bytes = engine_->memory_bytes();
}

/// Each thing once.
void CarefulDevice::notify(const std::string& says) {
  const std::lock_guard lock(report_mutex_);
  report_.reason = says;
  if (told_.insert(says).second) untold_.push_back(says + ": the processor matches instead");
}

/// Without the report's lock: a receiver may ask for the report.
void CarefulDevice::tell() {
  std::vector<std::string> all;
  {
    const std::lock_guard lock(report_mutex_);
    all.swap(untold_);
  }
  if (!notice_) return;
  for (const std::string& says : all) notice_(says);
}

}  // namespace cairn::device
