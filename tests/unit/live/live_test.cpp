// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cairn/core/error.hpp>
#include <cairn/live/looped.hpp>
#include <cairn/live/queued_sink.hpp>
#include <cairn/live/runner.hpp>
#include <cairn/live/topics.hpp>
#include <cstring>
#include <functional>
#include <thread>

#include "support/samples.hpp"

namespace cairn::live {
namespace {

using namespace std::chrono_literals;

constexpr Size kSize{64, 48};

/// A camera that delivers `frames` pairs, one each `period`, whether they are read or not; or a file.
class Camera : public input::Sequence {
 public:
  Camera(int frames, std::chrono::milliseconds period, bool is_live)
      : frames_(frames), period_(period), is_live_(is_live) {}

  std::optional<input::SequenceFrame> next() override {
    if (at_ == frames_ || is_stopped_) return std::nullopt;
    std::this_thread::sleep_for(period_);
    input::SequenceFrame frame;
    frame.name = std::to_string(at_);
    frame.index = static_cast<std::size_t>(at_);
    frame.stamp = {at_ * std::int64_t{10'000'000}};
    frame.left.gray = Image<Gray>(kSize);
    frame.right = Image<Gray>(kSize);
    for (int y = 0; y < kSize.height; ++y) {
      for (int x = 0; x < kSize.width; ++x) {
        frame.left.gray(x, y) = static_cast<Gray>((x * 37 + y * 101 + x * y) % 251);
        frame.right(x, y) = static_cast<Gray>(((x + 3) * 37 + y * 101 + (x + 3) * y) % 251);
      }
    }
    if (is_live_) frame.arrived = Clock::now() - delay;
    ++at_;
    return frame;
  }
  [[nodiscard]] std::optional<std::size_t> size() const override { return std::nullopt; }
  [[nodiscard]] std::string name() const override { return "camera"; }
  [[nodiscard]] Size image_size() const override { return kSize; }
  [[nodiscard]] const std::optional<StereoRig>& rig() const override { return rig_; }
  [[nodiscard]] std::optional<int> disparities() const override { return 16; }
  [[nodiscard]] const KnownGround& ground() const override { return ground_; }
  [[nodiscard]] const io::Rectifier* rectifier() const override { return nullptr; }
  [[nodiscard]] std::string stamps_from() const override { return "the test"; }
  [[nodiscard]] const std::vector<input::SourceRemark>& remarks() const override { return remarks_; }
  [[nodiscard]] const std::string& ended_early() const override { return none_; }
  void lose_calibration() { rig_.reset(); }
  void stop() override { is_stopped_ = true; }
  [[nodiscard]] input::SourceStatus status() const override {
    input::SourceStatus status;
    status.is_live = is_live_;
    status.dropped = 7;
    return status;
  }

  std::chrono::milliseconds delay{0};  // age of a pair on arrival

 private:
  int frames_;
  std::chrono::milliseconds period_;
  bool is_live_;
  int at_ = 0;
  std::atomic<bool> is_stopped_ = false;
  std::optional<StereoRig> rig_ = StereoRig{60, 32, 24, 0.1F, 0};
  KnownGround ground_;
  std::vector<input::SourceRemark> remarks_;
  std::string none_;
};

/// A camera with a gap before the second pair.
struct Gapped : Camera {
  using Camera::Camera;
  std::optional<input::SequenceFrame> next() override {
    auto frame = Camera::next();
    if (frame) frame->after_gap = frame->index == 1;
    return frame;
  }
};

/// Stores the frames it is offered, and calls `then` for each.
class Notebook : public Sink {
 public:
  void offer(const LiveFramePtr& frame) override {
    frames.push_back(frame);
    ++count;
    if (then) then(*frame);
  }
  void finish() override { is_finished = true; }
  std::vector<LiveFramePtr> frames;
  std::atomic<int> count = 0;  // of them, for other threads
  std::function<void(const LiveFrame&)> then;
  bool is_finished = false;
};

FollowConfig config() {
  FollowConfig all;
  all.segmentation.match.num_disparities = 16;
  return all;
}

LiveSummary run(input::Sequence& camera, const LiveOptions& options, Notebook& notebook,
                const Exec& exec = {}) {
  Runner runner(camera, "camera", {}, config(), options, exec);
  runner.add(notebook);
  return runner.run();
}

TEST(NewestSlot, GivesTheLatestAndCountsReplacedOnes) {
  NewestSlot<int> slot;
  EXPECT_EQ(slot.take(0ms), std::nullopt);
  slot.put(1);
  slot.put(2);
  slot.put(3);
  EXPECT_EQ(slot.replaced(), 2U);
  EXPECT_EQ(slot.take(0ms), 3);
  slot.put(4);
  slot.close();
  slot.put(5);
  EXPECT_FALSE(slot.is_closed()) << "there is one left";
  EXPECT_EQ(slot.take(1s), 4);
  EXPECT_EQ(slot.take(1s), std::nullopt);
  EXPECT_TRUE(slot.is_closed());
}

TEST(NewestSlot, AReplacedOneMayPassStateToTheNext) {
  NewestSlot<int> slot;
  const auto add = [](int& fresh, const int& old) { fresh += old; };
  slot.put(1, add);
  slot.put(10, add);
  slot.put(100, add);
  EXPECT_EQ(slot.take(0ms), 111);
}

TEST(Latencies, ArePercentilesOfTheAddedTimes) {
  Latencies all;
  EXPECT_EQ(all.percentile(0.5), 0);
  for (int ms = 1; ms <= 100; ++ms) all.add(ms);
  EXPECT_NEAR(all.percentile(0.5), 51, 0.2);
  EXPECT_NEAR(all.percentile(0.99), 100, 0.2);
  EXPECT_EQ(all.max_ms(), 100);
  all.add(1e9);
  EXPECT_EQ(all.max_ms(), 1e9) << "beyond the last step, but not lost";
}

TEST(Runner, ProcessesEveryFrameIfNoneMayBeDropped) {
  Camera camera(12, 0ms, false);
  Notebook notebook;
  LiveOptions options;
  options.every_frame = true;
  options.pace = 0;
  const LiveSummary summary = run(camera, options, notebook);
  EXPECT_EQ(summary.frames, 12U);
  ASSERT_EQ(notebook.frames.size(), 12U);
  for (std::size_t k = 0; k < 12; ++k) EXPECT_EQ(notebook.frames[k]->pair->index, k);
  EXPECT_EQ(summary.drops.replaced, 0U);
  EXPECT_TRUE(notebook.is_finished);
  EXPECT_FALSE(notebook.frames.back()->stages.empty());
  EXPECT_EQ(notebook.frames.back()->drops.at_source, 7U);
}

TEST(Runner, ANewerPairReplacesTheWaitingOne) {
  Camera camera(60, 1ms, true);
  Notebook notebook;
  notebook.then = [](const LiveFrame&) { std::this_thread::sleep_for(20ms); };  // a slow robot
  const LiveSummary summary = run(camera, {}, notebook);
  EXPECT_LT(summary.frames, 30U);
  EXPECT_EQ(summary.frames + summary.drops.replaced, 60U);
  for (std::size_t k = 1; k < notebook.frames.size(); ++k)
    EXPECT_GT(notebook.frames[k]->pair->index, notebook.frames[k - 1]->pair->index);
}

TEST(Runner, FramesThatOverlapAreTheSameFrames) {
  for (const bool has_tracks : {true, false}) {
    std::array<Notebook, 2> notebooks;
    for (const int threads : {1, 2}) {
      Camera camera(12, 0ms, false);
      LiveOptions options = LiveOptions::unpaced();
      options.tracks = has_tracks;
      run(camera, options, notebooks.at(static_cast<std::size_t>(threads - 1)), Exec::with_threads(threads));
    }
    ASSERT_EQ(notebooks[0].frames.size(), 12U);
    ASSERT_EQ(notebooks[1].frames.size(), 12U);
    for (std::size_t k = 0; k < 12; ++k) {
      const LiveFrame& expected = *notebooks[0].frames[k];
      const LiveFrame& found = *notebooks[1].frames[k];
      EXPECT_EQ(found.pair->index, k);
      EXPECT_EQ(found.step.index, expected.step.index);
      EXPECT_EQ(found.stages.size(), expected.stages.size());
      const View<const float> disparity = expected.step.frame.disparity.disparity_px;
      for (int y = 0; y < disparity.height(); ++y) {
        EXPECT_EQ(std::memcmp(found.step.frame.disparity.disparity_px.row(y), disparity.row(y),
                              static_cast<std::size_t>(disparity.width()) * sizeof(float)),
                  0);
      }
    }
  }
}

TEST(Runner, OfACameraFramesOverlapInOrderAndLoseNoGap) {
  Gapped camera(60, 1ms, true);
  Notebook notebook;
  notebook.then = [](const LiveFrame&) { std::this_thread::sleep_for(20ms); };
  const LiveSummary summary = run(camera, {}, notebook, Exec::with_threads(2));
  EXPECT_LT(summary.frames, 30U);
  EXPECT_EQ(summary.frames + summary.drops.replaced, 60U);
  std::size_t gaps = 0;
  for (std::size_t k = 0; k < notebook.frames.size(); ++k) {
    gaps += notebook.frames[k]->pair->after_gap ? 1 : 0;
    if (k > 0) {
      EXPECT_GT(notebook.frames[k]->pair->index, notebook.frames[k - 1]->pair->index);
    }
  }
  EXPECT_EQ(gaps, 1U);
}

TEST(Runner, PairsThatAreTooOldAreDroppedAndCounted) {
  Camera camera(5, 1ms, true);
  camera.delay = 500ms;
  Notebook notebook;
  LiveOptions options;
  options.max_age = 200ms;
  const LiveSummary summary = run(camera, options, notebook);
  EXPECT_EQ(summary.frames, 0U);
  EXPECT_GT(summary.drops.too_old, 0U);
}

TEST(Runner, AGapBeforeADroppedPairCountsForTheNext) {
  Gapped camera(40, 1ms, true);
  Notebook notebook;
  notebook.then = [](const LiveFrame&) { std::this_thread::sleep_for(30ms); };
  Runner runner(camera, "camera", {}, config(), {}, {});
  runner.add(notebook);
  runner.run();
  ASSERT_GE(notebook.frames.size(), 2U);
  std::size_t gaps = 0;
  for (const LiveFramePtr& frame : notebook.frames) gaps += frame->pair->after_gap ? 1 : 0;
  EXPECT_EQ(gaps, 1U);
}

TEST(Runner, EveryFrameHasTheFindingsAndTheFirstOneTheirChange) {
  Camera camera(3, 0ms, false);
  camera.lose_calibration();
  Notebook notebook;
  run(camera, LiveOptions::unpaced(), notebook);
  ASSERT_EQ(notebook.frames.size(), 3U);
  for (const LiveFramePtr& frame : notebook.frames) {
    ASSERT_FALSE(frame->findings.empty());
    EXPECT_EQ(info(frame->findings.front().kind).name, "no metres");
    EXPECT_EQ(frame->changes.empty(), frame->pair->index > 0);
    for (const Topic& topic : topics()) {
      if (topic.name != "stats" || topic.make == nullptr) continue;
      const MessagePtr stats = message_of(topic, *frame, {});
      const std::string text(stats->begin(), stats->end());
      EXPECT_NE(text.find(R"("findings":[{"finding":"no metres","severity":"note")"), std::string::npos)
          << text;
    }
  }
}

TEST(Runner, StepsCountOnlyWhileItIsPaused) {
  Camera camera(1'000'000, 1ms, false);
  Notebook notebook;
  LiveOptions options;
  options.every_frame = true;
  options.pace = 0;
  Runner runner(camera, "camera", {}, config(), options, {});
  runner.add(notebook);
  for (int k = 0; k < 100; ++k) runner.step();
  runner.pause(true);
  std::thread loop([&] { runner.run(); });
  std::this_thread::sleep_for(100ms);
  runner.step();
  std::this_thread::sleep_for(300ms);
  runner.stop();
  loop.join();
  EXPECT_LE(notebook.frames.size(), 2U) << "the one step, and the pair that waited when it ended";
  EXPECT_GE(notebook.frames.size(), 1U);
}

TEST(Runner, FilesArePlayedAtThePaceOfTheirStamps) {
  Camera camera(11, 0ms, false);  // 10 ms apart
  Notebook notebook;
  LiveOptions options;
  options.every_frame = true;
  options.pace = 0.5;
  const LiveSummary summary = run(camera, options, notebook);
  EXPECT_GE(summary.seconds, 0.2);
}

TEST(Runner, DoesNotWaitBetweenRounds) {
  const auto source = looped([] { return std::make_unique<Camera>(1, 0ms, false); });  // rounds are 2 s apart
  Notebook notebook;
  LiveOptions options;
  options.every_frame = true;
  options.is_ended = [&] { return notebook.count > 20; };
  EXPECT_LT(run(*source, options, notebook).seconds, 20);
}

TEST(Runner, MayAskForTheStatusWhileARoundBeginsAgain) {
  const auto source = looped([] { return std::make_unique<Camera>(1, 0ms, false); });
  Notebook notebook;
  LiveOptions options;
  options.pace = 0;
  options.is_ended = [&] { return notebook.count > 20; };
  EXPECT_LT(run(*source, options, notebook).seconds, 20);
  EXPECT_FALSE(source->status().is_live);
}

TEST(Runner, EndsAfterItsTimeAndOnRequest) {
  Camera endless(1'000'000, 1ms, true);
  Notebook notebook;
  LiveOptions options;
  options.duration = 150ms;
  EXPECT_LT(run(endless, options, notebook).seconds, 5);
  Camera other(1'000'000, 1ms, true);
  LiveOptions ended_early;
  ended_early.is_ended = [&] { return notebook.count > 5; };
  EXPECT_LT(run(other, ended_early, notebook).seconds, 5);
}

TEST(Runner, OptionsApplyFromTheNextFrameAndAreRefusedAsAWhole) {
  Camera camera(9, 0ms, false);
  Notebook notebook;
  LiveOptions options;
  options.every_frame = true;
  options.pace = 0;
  Runner runner(camera, "camera", {}, config(), options, {});
  runner.add(notebook);
  notebook.then = [&](const LiveFrame& frame) {
    if (frame.pair->index == 2) runner.set({{"objects.min_area", "1"}, {"tracking.min_hits", "2"}});
    if (frame.pair->index == 4) {
      EXPECT_THROW(runner.set({{"objects.min_area", "2"}, {"tracking.min_hits", "-5"}}), Error);
      EXPECT_THROW(runner.set({{"no.such", "2"}}), Error);
      EXPECT_THROW(runner.set({{"match.num_disparities", "640"}}), Error) << "more than the image is wide";
    }
    if (frame.pair->index == 6) runner.reset();
  };
  runner.run();
  const auto hits = [&](std::size_t k) { return notebook.frames[k]->config->tracking.min_hits; };
  const int first = config().tracking.min_hits;
  ASSERT_NE(first, 2);
  EXPECT_EQ(hits(2), first);
  EXPECT_EQ(hits(3), 2);
  EXPECT_EQ(hits(5), 2);
  EXPECT_EQ(hits(8), first);
  EXPECT_EQ(notebook.frames[8]->revision, 2U);
}

TEST(Runner, ShowsTheOptionThatTheSearchForBetterOnesSets) {
  struct OfSample : Camera {
    using Camera::Camera;
    std::optional<input::SequenceFrame> next() override {
      auto frame = Camera::next();
      if (frame) frame->left.gray = sample.images.left.gray.clone();
      if (frame) frame->right = sample.images.right.gray.clone();
      return frame;
    }
    [[nodiscard]] Size image_size() const override { return sample.pair().size(); }
    samples::Sample sample = samples::load("four_in_a_row");
  };
  OfSample camera(24, 0ms, false);
  Notebook notebook;
  LiveOptions options;
  options.every_frame = true;
  options.pace = 0;
  FollowConfig wrong;
  wrong.segmentation.objects.min_area = 60;
  wrong.control.method = ControlMethod::tune;
  wrong.control.budget = 1;
  wrong.control.window = 3;
  Runner runner(camera, "camera", {}, wrong, options, {});
  runner.add(notebook);
  runner.run();
  const auto set = std::ranges::find_if(
      notebook.frames, [](const LiveFramePtr& frame) { return frame->step.control.has_value(); });
  ASSERT_NE(set, notebook.frames.end());
  EXPECT_EQ((*set)->step.control->candidate.option, "objects.min_area");
  EXPECT_EQ((*set)->config->segmentation.objects.min_area, 60);
  ASSERT_NE(set + 1, notebook.frames.end());
  EXPECT_EQ((*(set + 1))->config->segmentation.objects.min_area, Config{}.objects.min_area);
  EXPECT_EQ((*(set + 1))->revision, (*set)->revision + 1);
}

TEST(Runner, AnErrorOfTheSourceIsThrownAfterAllSinksAreDone) {
  struct Broken : Camera {
    using Camera::Camera;
    std::optional<input::SequenceFrame> next() override {
      if (++calls > 3) throw Error("frame 3: is of another size");
      return Camera::next();
    }
    int calls = 0;
  };
  for (const bool every_frame : {true, false}) {
    Broken camera(10, 1ms, false);
    Notebook notebook;
    LiveOptions options;
    options.every_frame = every_frame;
    Runner runner(camera, "camera", {}, config(), options, {});
    runner.add(notebook);
    EXPECT_THROW(runner.run(), Error);
    EXPECT_TRUE(notebook.is_finished);
  }
}

TEST(Runner, GivesFramesOneByOneToo) {
  Camera camera(3, 0ms, false);
  Runner runner(camera, "camera", {}, config(), LiveOptions::unpaced(), {});
  for (int i = 0; i < 3; ++i) {
    const auto frame = runner.next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->step.index, i);
    EXPECT_EQ(frame->pair->name, std::to_string(i));
  }
  EXPECT_FALSE(runner.next());
}

TEST(Runner, APairMayBeProcessedInAnotherWay) {
  Camera camera(3, 0ms, false);
  Notebook notebook;
  LiveOptions options = LiveOptions::unpaced();
  options.step = [](const input::SequenceFrame& pair, const FollowConfig&, const Exec&) {
    TrackedFrame step;
    step.stamp = {pair.stamp.ns + 1};
    return step;
  };
  run(camera, options, notebook);
  ASSERT_EQ(notebook.frames.size(), 3U);
  EXPECT_EQ(notebook.frames[2]->step.stamp.ns, 20'000'001);
}

TEST(QueuedSink, PassesFramesOnAndCountsSkippedOnes) {
  Notebook slow;
  slow.then = [](const LiveFrame&) { std::this_thread::sleep_for(2ms); };
  QueuedSink queued(slow, "file", "frames skipped");
  for (int i = 0; i < 100; ++i) queued.offer(std::make_shared<LiveFrame>());
  queued.finish();
  EXPECT_TRUE(slow.is_finished);
  EXPECT_GE(slow.frames.size(), 16U);
  EXPECT_EQ(queued.summary(), "file: " + std::to_string(100 - slow.frames.size()) + " frames skipped");
}

TEST(QueuedSink, AnErrorOfItsSinkEndsTheRun) {
  Camera camera(1000, 1ms, false);
  Notebook full;
  full.then = [](const LiveFrame&) { throw Error("the disk is full"); };
  QueuedSink queued(full, "file", "frames skipped");
  LiveOptions options;
  options.every_frame = true;
  Runner runner(camera, "camera", {}, config(), options, {});
  runner.add(queued);
  EXPECT_THROW(runner.run(), Error);
  EXPECT_EQ(full.frames.size(), 1U);
  EXPECT_TRUE(full.is_finished);
}

TEST(Looped, ContinuesWithIncreasingStampsAndAGapBetweenRounds) {
  const auto source = looped([] { return std::make_unique<Camera>(3, 0ms, false); });
  Stamp before{-1};
  for (std::size_t k = 0; k < 10; ++k) {
    const auto frame = source->next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->index, k);
    EXPECT_GT(frame->stamp, before);
    EXPECT_EQ(frame->after_gap, k > 0 && k % 3 == 0);
    before = frame->stamp;
  }
  EXPECT_EQ(source->size(), std::nullopt);
  EXPECT_THROW((void)looped([] { return std::make_unique<Camera>(3, 0ms, true); }), Error);
  const auto empty = looped([] { return std::make_unique<Camera>(0, 0ms, false); });
  EXPECT_FALSE(empty->next());
}

}  // namespace
}  // namespace cairn::live
