// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/timing/frame_times.hpp>

#include <sys/resource.h>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/pipeline/segmenter.hpp>
#include <chrono>
#include <functional>
#include <set>
#include <string_view>
#include <utility>

#include <cairn/timing/clock.hpp>

namespace cairn::timing {
namespace {

using Clock = std::chrono::steady_clock;

double process_ms() {
  return now_ms(CLOCK_PROCESS_CPUTIME_ID);
}

std::int64_t most_resident_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::int64_t{1024} * usage.ru_maxrss;
}

struct TimedStage {
  double wall_ms = 0;
  double cpu_ms = 0;
  void add_to(Samples& samples) const {
    samples.wall_ms.push_back(wall_ms);
    samples.cpu_ms.push_back(cpu_ms);
  }
  TimedStage& operator+=(const TimedStage& other) {
    wall_ms += other.wall_ms;
    cpu_ms += other.cpu_ms;
    return *this;
  }
};

template <class Work>
TimedStage timed(const Work& work) {
  const double cpu = process_ms();
  const auto wall = Clock::now();
  work();
  const std::chrono::duration<double, std::milli> elapsed = Clock::now() - wall;
  return {elapsed.count(), process_ms() - cpu};
}

/// The stages of the current frame. A stage's processor time counts from the end of the previous stage, like
/// the observer's wall time.
class FrameClock {
 public:
  void begin_frame() {
    current_.clear();
    mark_ms_ = process_ms();
  }
  void operator()(std::string_view stage, double wall_ms) {
    const TimedStage elapsed{wall_ms, process_ms() - mark_ms_};
    const auto found = std::find_if(current_.begin(), current_.end(),
                                    [&](const auto& entry) { return entry.first == stage; });
    if (found == current_.end()) {
      current_.emplace_back(stage, elapsed);
    } else {
      found->second += elapsed;
    }
    mark_ms_ = process_ms();
  }
  [[nodiscard]] const std::vector<std::pair<std::string, TimedStage>>& stages() const { return current_; }

 private:
  std::vector<std::pair<std::string, TimedStage>> current_;
  double mark_ms_ = 0;
};

/// The stages that estimate_disparity() reports; so no list of stages is needed here.
std::set<std::string, std::less<>> disparity_stages(const StereoPair& pair,
                                                    const std::optional<StereoRig>& rig, const Config& config,
                                                    Exec exec) {
  std::set<std::string, std::less<>> names;
  exec.observe = [&](std::string_view stage, const StageResult&, double) { names.emplace(stage); };
  static_cast<void>(estimate_disparity(pair, rig, config, exec));
  return names;
}

struct Peer {
  ReadyMatcher matcher;
  PeerTimes times;
};

/// Warms up the matchers; those that refuse the pair give a reason and are not timed.
std::vector<Peer> prepare(std::span<const OpenCvMatcher> matchers, const StereoPair& pair,
                          const MatchConfig& config) {
  std::vector<Peer> peers;
  for (const OpenCvMatcher& matcher : matchers) {
    Peer peer{matcher.prepare({config.min_disparity, config.num_disparities}), {}};
    peer.times.matcher = &matcher;
    try {
      peer.matcher.compute(pair);
    } catch (const Error& error) {
      peer.times.refusal = error.what();
    }
    peers.push_back(std::move(peer));
  }
  return peers;
}

void add_frame(FrameTimes& all, const FrameClock& clock, const TimedStage& frame) {
  frame.add_to(all.frame);
  TimedStage disparity;
  for (std::size_t i = 0; i < all.stages.size(); ++i) {
    const TimedStage& elapsed = clock.stages().at(i).second;
    elapsed.add_to(all.stages[i].times);
    if (all.stages[i].for_disparity) disparity += elapsed;
  }
  disparity.add_to(all.disparity);
}

void add_overlapping(FrameTimes& all, const StereoPair& pair, const Segmenter& segmenter) {
  const int frames = all.frames();
  if (!segmenter.exec().overlaps_frames() || frames < 2) return;
  const TimedStage whole = timed([&] {
    segmenter.prefetch(pair);  // the first frame; the pair is always the same
    for (int k = 0; k < frames; ++k) {
      if (k + 1 < frames) segmenter.prefetch(pair);
      static_cast<void>(segmenter.segment(pair));
    }
  });
  all.overlapping_ms = whole.wall_ms / frames;
  all.overlapping_pool_bytes = segmenter.exec().pool.bytes();
}

}  // namespace

FrameTimes time_frames(const StereoPair& pair, const std::optional<StereoRig>& rig, const Config& config,
                       const Exec& exec, const Limits& limits, std::span<const OpenCvMatcher> matchers) {
  const int least = std::min(3, limits.frames);
  FrameTimes all;
  FrameClock clock;
  Exec watched = exec;
  watched.observe = [&clock](std::string_view stage, const StageResult&, double ms) { clock(stage, ms); };
  const Segmenter segmenter(config, rig, watched);
  const Pool& pool = segmenter.exec().pool;
  const auto run = [&] {
    return timed([&] {
      clock.begin_frame();
      static_cast<void>(segmenter.segment(pair));
    });
  };

  all.first_frame_ms = run().wall_ms;
  all.resident_bytes = most_resident_bytes();
  all.first_allocations = pool.heap_allocations();
  const auto for_disparity = disparity_stages(pair, rig, config, exec);
  for (const auto& [name, elapsed] : clock.stages())
    all.stages.push_back({name, for_disparity.contains(name), {}});

  std::vector<Peer> peers = prepare(matchers, pair, config.match);
  const auto start = Clock::now();
  const auto in_time = [&] {
    return all.frames() < least ||
           (all.frames() < limits.frames &&
            std::chrono::duration<double>(Clock::now() - start).count() < limits.seconds);
  };
  while (in_time()) {
    const TimedStage frame = run();
    add_frame(all, clock, frame);
    for (Peer& peer : peers) {
      if (peer.times.refusal.empty()) timed([&] { peer.matcher.compute(pair); }).add_to(peer.times.times);
    }
  }

  all.pool_bytes = pool.bytes();
  all.later_allocations = pool.heap_allocations() - all.first_allocations;
  const Frame frame = segmenter.segment(pair);
  all.objects = static_cast<int>(frame.objects.list.size());
  add_overlapping(all, pair, segmenter);
  all.disparity_px = frame.disparity.disparity_px.clone();
  for (Peer& peer : peers) {
    if (peer.times.refusal.empty()) peer.times.disparity_px = peer.matcher.disparity_px();
    all.peers.push_back(std::move(peer.times));
  }
  return all;
}

}  // namespace cairn::timing
