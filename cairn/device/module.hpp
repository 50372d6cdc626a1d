// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/device/device.hpp>
#include <cairn/io/load_module.hpp>

/// What cairn-vulkan.so offers.
extern "C" {
CAIRN_EXPORT std::vector<cairn::device::Listed>* cairn_list_devices();
/// Null: there is no device for "auto".
CAIRN_EXPORT cairn::MatchDevice* cairn_open_device(const std::string& wanted, const std::string& source,
                                                   const cairn::device::Notice& notice);
}
