// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/live/looped.hpp>

#include <cairn/core/error.hpp>
#include <cairn/input/sequence_over.hpp>
#include <utility>

namespace cairn::live {
namespace {

using input::Sequence;
using input::SequenceFrame;

class LoopedSequence : public input::SequenceOver {
 public:
  explicit LoopedSequence(std::function<std::unique_ptr<Sequence>()> open)
      : SequenceOver(open()), open_(std::move(open)), rig_(inner_->rig()), size_(inner_->image_size()) {
    if (inner_->status().is_live)
      throw Error(inner_->name() + ": is a camera, expected a source with an end to repeat");
  }

  std::optional<SequenceFrame> next() override {
    std::optional<SequenceFrame> frame = inner_->next();
    const bool begins_again = !frame && count_ > 0;
    if (begins_again) {
      inner_ = open_();
      frame = inner_->next();
      if (frame) {
        shift_ns_ = last_.ns + kPause_ns - frame->stamp.ns;
        frame->after_gap = true;
        frame->begins_round = true;
      }
    }
    if (!frame) return std::nullopt;
    frame->stamp.ns += shift_ns_;
    frame->index = count_++;
    last_ = frame->stamp;
    return frame;
  }

  [[nodiscard]] std::optional<std::size_t> size() const override { return std::nullopt; }
  [[nodiscard]] Size image_size() const override { return size_; }
  // Files have nothing to stop, and other threads may ask while the next round opens.
  void stop() override {}
  [[nodiscard]] input::SourceStatus status() const override { return {}; }
  [[nodiscard]] const std::optional<StereoRig>& rig() const override { return rig_; }

 private:
  static constexpr std::int64_t kPause_ns = 2'000'000'000;  // between rounds; more than a gap in the stamps

  std::function<std::unique_ptr<Sequence>()> open_;
  // Cached from the first round, as other threads may ask while the next one opens.
  std::optional<StereoRig> rig_;
  Size size_;
  std::size_t count_ = 0;
  std::int64_t shift_ns_ = 0;
  Stamp last_;
};

}  // namespace

std::unique_ptr<Sequence> looped(std::function<std::unique_ptr<Sequence>()> open) {
  return std::make_unique<LoopedSequence>(std::move(open));
}

}  // namespace cairn::live
