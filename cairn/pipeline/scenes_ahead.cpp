// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/pair_copy.hpp>
#include <cairn/pipeline/scenes_ahead.hpp>
#include <cairn/stereo/match_device.hpp>
#include <future>
#include <string>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

namespace cairn {
namespace {

Frame whole_frame(FrameInput in, const Run& run, const ObjectChoice& choose) {
  return run.config.pipeline.method == Method::paper ? segment_by_paper(std::move(in), run)
                                                     : segment_by_region_tree(std::move(in), run, choose);
}

}  // namespace

struct ScenesAhead::Begun {
  PairCopy images;
  std::shared_ptr<const Config> config;
  std::int64_t turn;
  FrameInput in;
  std::variant<RegionCandidates, Frame> found;  // with the method of the paper, a whole frame
  std::vector<std::pair<std::string, double>> times;
  std::future<void> done;  // last member: destroyed first, so the work ends before its data do

  Begun(const StereoPair& pair, std::shared_ptr<const Config> used, std::int64_t number, const Pool& pool)
      : images(pair, pool), config(std::move(used)), turn(number), in(FrameInput::from(images.pair())) {}

  void start(const std::optional<StereoRig>& rig, Exec exec, bool is_observed) {
    if (is_observed) {
      exec.observe = [this](std::string_view stage, const StageResult&, double ms) {
        times.emplace_back(stage, ms);
      };
    }
    done = std::async(std::launch::async, [this, rig, exec = std::move(exec)] {
      const Run run{rig, *config, exec};
      if (config->pipeline.method == Method::paper) {
        found = segment_by_paper(std::move(in), run);
      } else {
        found = grow_candidates(in, run);
      }
    });
  }

  Frame finish(const Run& run, const ObjectChoice& choose) {
    done.get();
    if (run.exec.observe) {
      for (const auto& [stage, ms] : times) run.exec.observe(stage, StageResult(std::monostate{}), ms);
    }
    if (auto* frame = std::get_if<Frame>(&found)) return std::move(*frame);
    return frame_of_candidates(in, std::move(std::get<RegionCandidates>(found)), run, choose);
  }
};

/// What segment() works with: frees its lane at the end.
struct ScenesAhead::Work {
  ScenesAhead& owner;
  Exec exec;
  std::shared_ptr<const Config> config;
  Lane* lane = nullptr;                          // null: more frames than lanes
  std::unique_ptr<Begun> begun{};                // null: nothing was begun with this pair
  std::array<std::unique_ptr<Begun>, 2> late{};  // begun before it, and never asked for

  /// `pair`: nullptr for external disparities, of which none is begun.
  Work(ScenesAhead& of, const StereoPair* pair) : owner(of) {
    const std::lock_guard lock(owner.mutex_);
    exec = owner.exec_;
    config = owner.config_;
    if (pair == nullptr) return;
    validate(*config, pair->size(), owner.rig_.has_value());
    if (owner.is_open_) take_lane(*pair);
  }
  Work(const Work&) = delete;
  Work& operator=(const Work&) = delete;
  ~Work() {
    if (lane == nullptr) return;
    begun.reset();
    const std::lock_guard lock(owner.mutex_);
    lane->is_used = false;
  }

 private:
  void take_lane(const StereoPair& pair) {
    lane = owner.oldest([&](const Begun& one) { return one.images.equals(pair); });
    if (lane != nullptr) {
      begun = std::move(lane->begun);
      while (Lane* const older = owner.oldest([&](const Begun& one) { return one.turn < begun->turn; }))
        late.at(late[0] ? 1 : 0) = std::move(older->begun);
    } else if (lane = owner.unused_lane(); lane == nullptr) {
      lane = owner.oldest([](const Begun&) { return true; });
      if (lane != nullptr) late[0] = std::move(lane->begun);
    }
    if (lane == nullptr) return;
    const auto is_at_work = [](const Lane& one) { return one.begun || one.is_used; };
    const bool is_alone = std::ranges::none_of(owner.lanes_, is_at_work);
    // Alone, a frame that was not begun has all threads.
    if (begun || !is_alone) {
      exec = lane->exec;
      exec.observe = owner.exec_.observe;
    }
    lane->is_used = true;  // last: the destructor frees it
  }
};

ScenesAhead::ScenesAhead(Config config, std::optional<StereoRig> rig, Exec exec)
    : rig_(rig), exec_(std::move(exec)), config_(std::make_shared<const Config>(std::move(config))) {
  validate(*config_);
}

ScenesAhead::~ScenesAhead() = default;

void ScenesAhead::open_lanes() {
  if (is_open_) return;
  const int threads = exec_.threads();
  const std::array<int, 2> share{(threads + 1) / 2, threads / 2};
  const std::array<Pool, 2> pools{exec_.pool, exec_.pool.beside(1)};
  for (std::size_t i = 0; i < lanes_.size(); ++i) {
    lanes_.at(i).exec = Exec::with_threads(share.at(i), exec_.target);
    lanes_.at(i).exec.pool = pools.at(i);
    lanes_.at(i).exec.device = exec_.device;
  }
  is_open_ = true;
}

ScenesAhead::Lane* ScenesAhead::unused_lane() {
  for (Lane& lane : lanes_)
    if (!lane.is_used && !lane.begun) return &lane;
  return nullptr;
}

void ScenesAhead::begin_on_device(const StereoPair& pair, const Config& config) {
  if (!exec_.device->takes_early(config.match)) return;
  Exec exec = exec_;
  exec.observe = nullptr;
  // Computed again by segment(): it costs a twentieth of what the device saves.
  const EpipolarCorrection aligned =
      config.epipolar_correction.max_rows < 0
          ? EpipolarCorrection{}
          : correct_epipolar(pair, config.match, config.epipolar_correction, exec);
  const StereoPair to_match = aligned.right.empty() ? pair : StereoPair::from(pair.left(), aligned.right);
  exec.device->begin(to_match, config.match, config.semi_global);
}

void ScenesAhead::begin(const StereoPair& pair) {
  if (!exec_.overlaps_frames()) return;
  const std::lock_guard lock(mutex_);
  validate(*config_, pair.size(), rig_.has_value());
  if (exec_.threads() == 1) {
    begin_on_device(pair, *config_);
    return;
  }
  open_lanes();
  Lane* const lane = unused_lane();
  if (lane == nullptr) return;
  auto begun = std::make_unique<Begun>(pair, config_, next_turn_++, lane->exec.pool);
  try {
    begun->start(rig_, lane->exec, exec_.observe != nullptr);
  } catch (const std::system_error&) {  // the system has no thread left: the frame waits for its turn
    return;
  }
  lane->begun = std::move(begun);
}

ScenesAhead::Lane* ScenesAhead::oldest(const std::function<bool(const Begun&)>& is_wanted) {
  Lane* found = nullptr;
  for (Lane& lane : lanes_) {
    if (lane.begun && is_wanted(*lane.begun) && (found == nullptr || lane.begun->turn < found->begun->turn))
      found = &lane;
  }
  return found;
}

Frame ScenesAhead::segment(const StereoPair& pair, const ObjectChoice& choose) {
  const Work work(*this, &pair);
  const Run run{rig_, *work.config, work.exec};
  if (work.begun) return work.begun->finish(run, choose);
  return whole_frame(FrameInput::from(pair), run, choose);
}

Frame ScenesAhead::segment(const LeftImage& left, View<const float> disparity_px,
                           const ObjectChoice& choose) {
  const Work work(*this, nullptr);
  FrameInput in{left, {}, with_holes_marked(disparity_px, work.exec)};
  return whole_frame(std::move(in), {rig_, *work.config, work.exec}, choose);
}

void ScenesAhead::set_config(Config config) {
  validate(config);
  const std::lock_guard lock(mutex_);
  config_ = std::make_shared<const Config>(std::move(config));
  for (Lane& lane : lanes_) lane.begun.reset();
}

}  // namespace cairn
