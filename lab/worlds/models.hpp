// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "lab/worlds/families.hpp"
#include "lab/worlds/looks.hpp"
#include "lab/worlds/mesh.hpp"

namespace cairn::worlds {

/// A furniture model of Debian's sweethome3d-furniture (CC-BY 3.0 or CC0).
struct Model {
  std::string name;
  std::string file;  // the library
  std::string path;  // of the OBJ file in it
  Vec3 size_m;
  [[nodiscard]] float longest_m() const { return std::max({size_m.x, size_m.y, size_m.z}); }
};

/// The models of the library that belongs to this use: Scopia for the fit, BlendSwap-CC-0 for the yardstick. Without
/// kinds that only the validation sets may have. Empty if the package is not installed.
const std::vector<Model>& models_for(Use use);

struct ModelMesh {
  Mesh mesh;  // on z = 0, in its real size
  std::array<Look, 4> looks;
};
/// Empty if it cannot be read.
ModelMesh mesh_of(const Model& model);

/// Whether Debian's lomiri-wallpapers-16.04 is installed, of which photographs under CC0 and CC-BY are used.
bool has_photographs();
/// A random part of one of them; empty without that package. Throws Error if one of them is missing.
TextureImage photograph(Dice& dice);

}  // namespace cairn::worlds
