// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/objects/measure.hpp>
#include <string>

namespace cairn::python {

std::string object_repr(const Object& object);

}  // namespace cairn::python
