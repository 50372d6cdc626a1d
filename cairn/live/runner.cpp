// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/live/runner.hpp>

#include <cairn/core/error.hpp>
#include <cairn/pipeline/scenes_ahead.hpp>
#include <thread>
#include <utility>

namespace cairn::live {
namespace {

using namespace std::chrono_literals;

/// Interval at which a wait checks whether to give up.
constexpr auto kNotice = 50ms;
/// Between two maps that sinks get.
constexpr auto kMapInterval = 1s;

Exec noting_stages(Exec exec, std::vector<output::StageTime>& stages, std::function<void()> also) {
  exec.observe = [&stages, also = std::move(also)](std::string_view stage, const StageResult&, double ms) {
    stages.push_back({std::string(stage), ms});
    also();
  };
  if (exec.pool.bytes() == 0) exec.pool = Pool::make();
  return exec;
}

}  // namespace

Runner::Runner(input::Sequence& source, const std::string& source_name, const SensorFiles& files,
               FollowConfig config, LiveOptions options, const Exec& exec)
    : source_(source),
      image_size_(source.image_size()),
      has_rig_(source.rig().has_value()),
      options_(std::move(options)),
      exec_(noting_stages(exec, stages_, [this] { note_alive(); })),
      follow_(source, source_name, files, config, exec_),
      first_config_(std::make_shared<const FollowConfig>(std::move(config))),
      used_config_(first_config_),
      config_(first_config_) {
  validate(first_config_->segmentation, image_size_, has_rig_);
  if (!options_.tracks)
    single_ = std::make_unique<ScenesAhead>(first_config_->segmentation, source.rig(), exec_);
}

Runner::~Runner() = default;

bool Runner::is_over() const {
  return is_stopped_ || (options_.is_ended && options_.is_ended()) ||
         (deadline_ && Clock::now() >= *deadline_);
}

LiveSummary Runner::run() {
  const Clock::time_point began = Clock::now();
  if (options_.duration) deadline_ = began + *options_.duration;
  NewestSlot<PairPtr> slot;
  std::exception_ptr trouble;
  std::thread reader;
  if (!options_.every_frame) {
    reader = std::thread([&] {
      try {
        read_source(slot);
      } catch (...) {
        trouble = std::current_exception();
      }
      slot.close();
    });
  }
  const auto end = [&] {
    is_stopped_ = true;
    source_.stop();
    if (reader.joinable()) reader.join();
    has_failed_ = has_failed_ || trouble;
    was_ended_ = options_.is_ended && options_.is_ended();
    offer_map();
    std::exception_ptr unfinished;
    for (Sink* sink : sinks_) {
      try {
        sink->finish();
      } catch (...) {
        if (!unfinished) unfinished = std::current_exception();
        has_failed_ = true;
      }
    }
    follow_.close(has_failed_ ? RunState::aborted : was_ended_ ? options_.when_ended : RunState::done);
    if (unfinished) std::rethrow_exception(unfinished);
  };
  const auto offer = [&](const LiveFramePtr& frame) {
    for (Sink* sink : sinks_) sink->offer(frame);
    if (frame->done - map_offered_ >= kMapInterval) offer_map();
  };
  try {
    if (options_.every_frame) {
      while (const LiveFramePtr frame = next()) offer(frame);
    } else {
      while (PairPtr pair = newest(slot)) offer(work(std::move(pair), source_.status()));
    }
  } catch (...) {
    const std::exception_ptr first = std::current_exception();
    has_failed_ = true;
    try {
      end();
    } catch (const Error&) {  // the first error is more informative
    }
    std::rethrow_exception(first);
  }
  end();
  if (trouble) std::rethrow_exception(trouble);
  const double seconds = std::chrono::duration<double>(Clock::now() - began).count();
  return {latencies_.count(), drops_, seconds, latencies_.percentile(0.5), latencies_.percentile(0.99),
          latencies_.max_ms()};
}

Runner::ReadPair Runner::read_next() {
  ReadPair read;
  try {
    auto pair = source_.next();
    read.status = source_.status();
    if (pair) read.pair = std::make_shared<input::SequenceFrame>(std::move(*pair));
  } catch (...) {
    read.trouble = std::current_exception();
  }
  return read;
}

std::shared_ptr<LiveFrame> Runner::next() {
  if (is_over()) return nullptr;
  const ReadPair read = read_ahead_ ? *std::exchange(read_ahead_, std::nullopt) : read_next();
  if (read.trouble) std::rethrow_exception(read.trouble);
  if (!read.pair) return nullptr;
  wait_for_its_time(*read.pair);
  // Of a camera, and of a file that is played at its pace, the next pair is not there yet.
  if (options_.pace == 0 && !read.status.is_live && !is_paused_) {
    read_ahead_ = read_next();
    if (read_ahead_->pair) prefetch(*read_ahead_->pair);
  }
  return work(read.pair, read.status);
}

void Runner::prefetch(const input::SequenceFrame& pair) {
  if (options_.step || !pair.disparity_px.empty()) return;
  if (single_) {
    single_->begin(input::pair_of(pair));
  } else {
    follow_.prefetch(pair);
  }
}

/// The newest pair that is not too old, or the one that is begun already; null at the end.
Runner::PairPtr Runner::newest(NewestSlot<PairPtr>& slot) {
  const auto is_young = [&](const input::SequenceFrame& pair) {
    return !options_.max_age || !pair.arrived || Clock::now() - *pair.arrived <= *options_.max_age;
  };
  {
    const std::lock_guard lock(prefetched_mutex_);
    is_working_ = false;
  }
  while (!is_over()) {
    PairPtr pair;
    {
      const std::lock_guard lock(prefetched_mutex_);
      pair = std::exchange(prefetched_, nullptr);
    }
    if (!pair) pair = slot.take(kNotice).value_or(nullptr);
    if (!pair && slot.is_closed()) return nullptr;
    drops_.replaced = slot.replaced();
    if (!pair) {
      note_alive();
      continue;
    }
    if (!is_young(*pair)) {
      ++drops_.too_old;
      is_after_gap_ = is_after_gap_ || pair->after_gap;
      continue;
    }
    pair->after_gap = pair->after_gap || std::exchange(is_after_gap_, false);
    const std::lock_guard lock(prefetched_mutex_);
    is_working_ = true;
    if (overlaps_frames()) prefetched_ = slot.take(0ns).value_or(nullptr);
    if (prefetched_) prefetch(*prefetched_);
    return pair;
  }
  return nullptr;
}

/// Whether a pair can be begun beside the one before: else the newest is better.
bool Runner::overlaps_frames() const {
  if (options_.step) return false;
  if (exec_.threads() > 1) return true;
  const std::lock_guard lock(mutex_);
  return exec_.device && exec_.device->takes_early(config_->segmentation.match);
}

/// Takes a pair that arrives while a frame is at work, and no other has been begun: the threads share both frames.
bool Runner::begins_early(input::SequenceFrame& pair) {
  const std::lock_guard lock(prefetched_mutex_);
  if (!overlaps_frames() || !is_working_ || prefetched_) return false;
  prefetched_ = std::make_shared<input::SequenceFrame>(std::move(pair));
  prefetch(*prefetched_);
  return true;
}

/// On its own thread, so that the source never waits.
void Runner::read_source(NewestSlot<PairPtr>& slot) {
  while (!is_over()) {
    auto pair = source_.next();
    if (!pair) return;
    wait_for_its_time(*pair);
    if (!pair->arrived) pair->arrived = Clock::now();
    if (begins_early(*pair)) continue;
    // A gap before a dropped pair counts for the next one.
    slot.put(
        std::make_shared<input::SequenceFrame>(std::move(*pair)),
        [](PairPtr& fresh, const PairPtr& old) { fresh->after_gap = fresh->after_gap || old->after_gap; });
  }
}

/// Files are played at the pace of their stamps; cameras set their own.
void Runner::wait_for_its_time(const input::SequenceFrame& pair) {
  if (source_.status().is_live) return;
  bool was_paused = false;
  while (is_paused_ && !is_over()) {
    was_paused = true;
    if (options_.every_frame) note_alive();
    std::uint64_t left = steps_;
    if (left > 0 && steps_.compare_exchange_strong(left, left - 1)) break;
    std::this_thread::sleep_for(10ms);
  }
  const Clock::time_point now = Clock::now();
  Clock::time_point due = now;
  if (played_ && !was_paused && !pair.begins_round && options_.pace > 0) {
    const double seconds = seconds_between(played_->first, pair.stamp) / options_.pace;
    due =
        played_->second + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    // Frames are not sped up to make up for a delay.
    if (due < now) due = now;
  }
  while (Clock::now() < due && !is_over()) {
    std::this_thread::sleep_until(std::min(due, Clock::now() + kNotice));
    if (options_.every_frame) note_alive();  // else another thread waits here
  }
  played_ = {pair.stamp, due};
}

void Runner::note_alive() const {
  for (Sink* sink : sinks_) sink->note_alive();
}

/// A copy, as the next frame changes the map.
void Runner::offer_map() {
  map_offered_ = Clock::now();
  std::shared_ptr<const LandmarkMap> map;
  for (Sink* sink : sinks_) {
    if (!sink->wants_map()) continue;
    if (!map) map = std::make_shared<const LandmarkMap>(follow_.marked().state.map);
    sink->offer_map(map, follow_.marked().state.run);
  }
}

TrackedFrame Runner::step_of(const input::SequenceFrame& pair) {
  if (options_.step) return options_.step(pair, *used_config_, exec_);
  if (options_.tracks) return follow_.next(pair);
  TrackedFrame step;
  step.index = frames_;
  step.stamp = pair.stamp;
  step.is_lost = true;
  step.frame = pair.disparity_px.empty()
                   ? single_->segment(input::pair_of(pair))
                   : single_->segment({pair.left.gray, pair.left.rgb}, pair.disparity_px);
  return step;
}

std::shared_ptr<LiveFrame> Runner::work(PairPtr pair, const input::SourceStatus& status) {
  take_config();
  auto frame = std::make_shared<LiveFrame>();
  frame->started = Clock::now();
  stages_.clear();
  frame->step = step_of(*pair);
  frame->landmarks = follow_.marked().tracks;
  frame->events = follow_.marked().events;
  frame->map_from_odom = follow_.marked().state.map_from_odom();
  frame->camera_covariance = camera_covariance(follow_.marked().state.located, frame->step.pose_covariance);
  take_over(frame->step.control);
  judge(*frame, *pair);
  ++frames_;
  frame->arrived = pair->arrived.value_or(frame->started);
  frame->pair = std::move(pair);
  frame->done = Clock::now();
  frame->stages = stages_;
  frame->source = status;
  drops_.at_source = frame->source.dropped + frame->source.unpaired;
  frame->drops = drops_;
  if (exec_.device) frame->device = exec_.device->report();
  frame->config = used_config_;
  frame->revision = used_revision_;
  recent_.push_back(frame->done);
  while (recent_.size() > 2 && frame->done - recent_.front() > 2s) recent_.pop_front();
  if (recent_.size() > 1) {
    frame->rate_hz = static_cast<double>(recent_.size() - 1) /
                     std::chrono::duration<double>(recent_.back() - recent_.front()).count();
  }
  latencies_.add(ms_between(frame->arrived, frame->done));
  return frame;
}

/// After the stages, whose times do not include it. Another way to process a pair may leave no disparity to judge.
void Runner::judge(LiveFrame& frame, const input::SequenceFrame& pair) {
  if (!frame.step.frame.disparity.disparity_px.empty()) {
    frame.changes = watch_.next(frame.step.frame, pair.left.gray, pair.right, source_.rig(),
                                used_config_->segmentation, exec_, pair.disparity_px);
  }
  frame.findings = watch_.findings();
}

void Runner::take_config() {
  const std::lock_guard lock(mutex_);
  if (revision_ == used_revision_) return;
  follow_.set_config(*config_);
  if (single_) single_->set_config(config_->segmentation);
  used_config_ = config_;
  used_revision_ = revision_;
}

/// Adds an option that the search for better ones has set to the configuration, unless it was changed meanwhile.
void Runner::take_over(const std::optional<ControlEvent>& control) {
  if (!control || !control->is_set) return;
  const std::lock_guard lock(mutex_);
  FollowConfig changed = *config_;
  if (value_of(changed.segmentation, control->candidate.option) != control->before) return;
  cairn::set(changed, control->candidate.option, control->candidate.value);
  config_ = std::make_shared<const FollowConfig>(std::move(changed));
  ++revision_;
}

void Runner::set(const std::vector<std::pair<std::string, std::string>>& options) {
  const std::lock_guard lock(mutex_);
  FollowConfig changed = *config_;
  for (const auto& [name, value] : options) cairn::set(changed, name, value);
  validate(changed);
  validate(changed.segmentation, image_size_, has_rig_);
  config_ = std::make_shared<const FollowConfig>(std::move(changed));
  ++revision_;
}

void Runner::reset() {
  const std::lock_guard lock(mutex_);
  config_ = first_config_;
  ++revision_;
}

std::shared_ptr<const FollowConfig> Runner::config() const {
  const std::lock_guard lock(mutex_);
  return config_;
}

}  // namespace cairn::live
