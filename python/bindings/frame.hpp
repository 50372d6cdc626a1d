// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/pipeline/segment.hpp>
#include <io/results.hpp>
#include <memory>
#include <utility>

#include "define.hpp"

namespace cairn::python {

/// A frame with its inputs. The frame may be part of an object that it keeps alive.
struct PyFrame {
  PyFrame(Picture l, std::shared_ptr<Frame> whole, io::Provenance how)
      : left(std::move(l)), owner(std::move(whole)), frame(*owner), provenance(std::move(how)) {}
  PyFrame(Picture l, Frame made, io::Provenance how)
      : PyFrame(std::move(l), std::make_shared<Frame>(std::move(made)), std::move(how)) {}

  Picture left;
  std::shared_ptr<Frame> owner;
  Frame& frame;
  io::Provenance provenance;
};

}  // namespace cairn::python
