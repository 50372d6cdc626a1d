// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/input/sequence.hpp>
#include <memory>
#include <utility>

namespace cairn::input {

/// A sequence that changes something of another one; the rest is that of the other. Private to the library.
class SequenceOver : public Sequence {
 public:
  explicit SequenceOver(std::unique_ptr<Sequence> inner) : inner_(std::move(inner)) {}
  std::optional<SequenceFrame> next() override { return inner_->next(); }
  [[nodiscard]] std::optional<std::size_t> size() const override { return inner_->size(); }
  [[nodiscard]] std::string name() const override { return inner_->name(); }
  [[nodiscard]] Size image_size() const override { return inner_->image_size(); }
  [[nodiscard]] const std::optional<StereoRig>& rig() const override { return inner_->rig(); }
  [[nodiscard]] std::optional<int> disparities() const override { return inner_->disparities(); }
  [[nodiscard]] const KnownGround& ground() const override { return inner_->ground(); }
  [[nodiscard]] const io::Rectifier* rectifier() const override { return inner_->rectifier(); }
  [[nodiscard]] std::string frame_id() const override { return inner_->frame_id(); }
  [[nodiscard]] std::string stamps_from() const override { return inner_->stamps_from(); }
  [[nodiscard]] const std::vector<SourceRemark>& remarks() const override { return inner_->remarks(); }
  [[nodiscard]] const std::string& ended_early() const override { return inner_->ended_early(); }
  void stop() override { inner_->stop(); }
  [[nodiscard]] SourceStatus status() const override { return inner_->status(); }

 protected:
  std::unique_ptr<Sequence> inner_;
};

}  // namespace cairn::input
