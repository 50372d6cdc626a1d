// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

namespace cairn::io {

/// The documents of a YAML text from outside. Also throws YAML::Exception where YAML::LoadAll() would not end
/// (a comma at the start of a document makes empty documents until memory is exhausted; yaml-cpp 0.7, 0.8),
/// and above 200 000 values.
std::vector<YAML::Node> yaml_documents(const std::string& text);

}  // namespace cairn::io
