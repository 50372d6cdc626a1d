// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/stereo/epipolar_correction.hpp>

namespace cairn::reference {

Image<Gray> shift_rows(View<const Gray> right, const EpipolarOffset& offset);

}  // namespace cairn::reference
