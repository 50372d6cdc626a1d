// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#define CAIRN_COST Cost::sad
#include <cairn/stereo/window_kernels_of_cost-inl.hpp>
