// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

namespace cairn::io {

/// The documents of a text that others wrote. Throws YAML::Exception also where YAML::LoadAll() would not
/// end: a comma where a document should begin makes empty documents until the memory is used up (yaml-cpp
/// 0.7, 0.8), and beyond 200 000 values.
std::vector<YAML::Node> yaml_documents(const std::string& text);

}  // namespace cairn::io
