// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/binned_sequence.hpp>

#include <cairn/image/binning.hpp>
#include <cairn/input/sequence_over.hpp>
#include <cairn/io/calibration_files.hpp>

namespace cairn::input {
namespace {

class BinnedSequence : public SequenceOver {
 public:
  BinnedSequence(std::unique_ptr<Sequence> inner, int factor, const Pool& pool)
      : SequenceOver(std::move(inner)),
        factor_(factor),
        pool_(pool),
        calibration_(io::binned({inner_->rig(), {}, inner_->disparities(), inner_->ground()},
                                inner_->image_size(), factor)) {}

  std::optional<SequenceFrame> next() override {
    std::optional<SequenceFrame> frame = inner_->next();
    if (!frame) return frame;
    frame->left = io::binned(frame->left, factor_, pool_);
    if (!frame->right.empty()) frame->right = cairn::binned(frame->right, factor_, pool_);
    if (!frame->disparity_px.empty())
      frame->disparity_px = binned_disparity(frame->disparity_px, factor_, pool_);
    return frame;
  }
  [[nodiscard]] Size image_size() const override { return *calibration_.image_size; }
  [[nodiscard]] const std::optional<StereoRig>& rig() const override { return calibration_.rig; }
  [[nodiscard]] std::optional<int> disparities() const override { return calibration_.num_disparities; }
  [[nodiscard]] const KnownGround& ground() const override { return calibration_.ground; }

 private:
  int factor_;
  Pool pool_;
  io::Calibration calibration_;
};

}  // namespace

std::unique_ptr<Sequence> binned(std::unique_ptr<Sequence> sequence, int factor, const Pool& pool) {
  return std::make_unique<BinnedSequence>(std::move(sequence), factor, pool);
}

}  // namespace cairn::input
