// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "lab/worlds/models.hpp"

#include <assimp/MemoryIOWrapper.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <zip.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cairn/core/error.hpp>
#include <cairn/io/raster.hpp>
#include <cairn/io/read_file.hpp>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string_view>

#include "lab/worlds/shapes.hpp"

namespace cairn::worlds {
namespace {

constexpr const char* kFolder = "/usr/share/sweethome3d/furniture/";
constexpr float kLeast = 0.04F, kMost = 2.6F;  // m, the longest side
constexpr float kFlat = 0.02F;                 // m; what is lower is no thing

constexpr const char* kPhotographFolder = "/usr/share/backgrounds/";
constexpr int kPhotographSide = 768;  // px, the shorter one
constexpr std::size_t kMostBytes = std::size_t{1} << 24U;
// Those under CC0 or CC-BY: none of share-alike, whose meaning for fitted numbers is not settled.
constexpr std::array<std::string_view, 10> kPhotographs{"Picture_0B_by_freespace",
                                                        "Picture_1A_by_freespace",
                                                        "Wine_by_Jakkub_Mede",
                                                        "aitzgorri_by_Aitzol_Berasategi",
                                                        "friends_by_Aitzol_Berasategi",
                                                        "life_by_Aitzol_Berasategi",
                                                        "picosdeeuropa_by_Aitzol_Berasategi",
                                                        "seeding_by_Clements_Engelhardt",
                                                        "sunset_by_Aitzol_Berasategi",
                                                        "umang_by_Abhishek_Mudgal"};

/// Kinds that only the validation sets may have, and what is no thing that stands.
constexpr std::array<std::string_view, 34> kLeftOut{
    "ladder",         "laptop",     "notebook", "tyre",           "tire",    "broom",   "crate",
    "barrel",         "drawer",     "dresser",  "puff",           "pouf",    "pedal",   "extinguisher",
    "office chair",   "desk chair", "swivel",   "pine",           "fir",     "cypress", "conifer",
    "christmas tree", "van",        "scooter",  "sandwich board", "railing", "plug",    "switch",
    "socket",         "door",       "window",   "pool",           "carpet",  "curtain"};

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// Whether a word of the name begins with one of those.
bool is_left_out(const std::string& name) {
  const std::string words = " " + lower(name);
  return std::ranges::any_of(kLeftOut, [&](std::string_view word) {
    return words.find(" " + std::string(word)) != std::string::npos;
  });
}

/// The files in a zip archive, for Assimp.
class Archive : public Assimp::IOSystem {
 public:
  explicit Archive(const std::string& file) : zip_(zip_open(file.c_str(), ZIP_RDONLY, nullptr)) {}
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;
  ~Archive() override {
    if (zip_ != nullptr) zip_discard(zip_);
  }

  /// Empty if there is no such file.
  [[nodiscard]] std::string content(std::string name) const {
    if (name.starts_with('/')) name.erase(0, 1);
    std::ranges::replace(name, '\\', '/');
    zip_stat_t about;
    if (zip_ == nullptr || zip_stat(zip_, name.c_str(), ZIP_FL_NOCASE, &about) != 0) return {};
    std::string bytes(about.size, '\0');
    zip_file_t* const file = zip_fopen_index(zip_, about.index, 0);
    if (file == nullptr) return {};
    const zip_int64_t read = zip_fread(file, bytes.data(), about.size);
    zip_fclose(file);
    return read == static_cast<zip_int64_t>(about.size) ? bytes : std::string();
  }

  bool Exists(const char* name) const override { return !content(name).empty(); }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* name, const char* /*mode*/) override {
    const std::string bytes = content(name);
    if (bytes.empty()) return nullptr;
    auto* const copy = new std::uint8_t[bytes.size()];  // the stream deletes it
    std::ranges::copy(bytes, copy);
    return new Assimp::MemoryIOStream(copy, bytes.size(), true);
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }

 private:
  zip_t* zip_;
};

std::vector<Model> catalogue(const std::string& file) {
  const Archive archive(file);
  std::map<int, std::map<std::string, std::string>> entries;
  std::istringstream lines(archive.content("PluginFurnitureCatalog.properties"));
  for (std::string line; std::getline(lines, line);) {
    const std::size_t number = line.find('#'), value = line.find('=');
    if (number == std::string::npos || value == std::string::npos || number == 0 || number > value) continue;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    entries[std::atoi(line.c_str() + number + 1)][line.substr(0, number)] = line.substr(value + 1);
  }
  std::vector<Model> models;
  for (auto& [number, entry] : entries) {
    const auto metres = [&](const char* key) { return 0.01F * std::strtof(entry[key].c_str(), nullptr); };
    Model model{entry["name"], file, entry["model"], {metres("width"), metres("depth"), metres("height")}};
    const float longest = model.longest_m();
    const bool is_thing = entry["doorOrWindow"] != "true" && !entry.contains("modelRotation") &&
                          metres("elevation") < 1.2F && model.size_m.z >= kFlat && longest >= kLeast &&
                          longest <= kMost;
    if (is_thing && !model.path.empty() && !is_left_out(model.name + " " + entry["id"]))
      models.push_back(std::move(model));
  }
  return models;
}

/// In RGB; empty if it cannot be read.
cv::Mat picture_of(const std::string& bytes) {
  if (bytes.empty()) return {};
  io::Raster raster;
  try {
    raster = io::decode_raster(bytes, io::Palette::colours);
  } catch (const Error&) {
    return {};
  }
  if (raster.bytes_each != 1) return {};
  cv::Mat picture = cv::Mat(raster.size.height, raster.size.width, raster.channels == 3 ? CV_8UC3 : CV_8UC1,
                            raster.bytes.data())
                        .clone();
  if (raster.channels == 1) cv::cvtColor(picture, picture, cv::COLOR_GRAY2RGB);
  return picture;
}

TextureImage texture_of(const cv::Mat& picture) {
  cv::Mat small;
  cv::resize(picture, small, {kImageSide, kImageSide}, 0, 0, cv::INTER_AREA);
  std::vector<std::array<std::uint8_t, 3>> image;
  for (int y = kImageSide - 1; y >= 0; --y) {  // v goes up
    for (int x = 0; x < kImageSide; ++x) {
      const auto& c = small.at<cv::Vec3b>(y, x);
      image.push_back({c[0], c[1], c[2]});
    }
  }
  return std::make_shared<const std::vector<std::array<std::uint8_t, 3>>>(std::move(image));
}

std::filesystem::path file_of(std::string_view photograph) {
  return kPhotographFolder + std::string(photograph) + ".jpg";
}

/// The photographs of the package, scaled down: all or, without the package, none.
std::vector<cv::Mat> photographs() {
  std::vector<cv::Mat> all;
  if (!has_photographs()) return all;
  for (const std::string_view name : kPhotographs) {
    const cv::Mat picture = picture_of(io::read_file(file_of(name), kMostBytes));
    if (picture.empty()) throw Error(file_of(name).string() + ": cannot be decoded");
    const double scale = static_cast<double>(kPhotographSide) / std::min(picture.rows, picture.cols);
    cv::resize(picture, all.emplace_back(), {}, scale, scale, cv::INTER_AREA);
  }
  return all;
}

Look look_of(const aiMaterial& material, const Archive& archive, const std::string& folder) {
  Look look;
  aiColor3D diffuse(0.6F, 0.6F, 0.6F);
  material.Get(AI_MATKEY_COLOR_DIFFUSE, diffuse);
  const auto linear = [](float x) { return std::pow(std::clamp(x, 0.02F, 0.95F), 2.2F); };
  look.colours.fill({linear(diffuse.r), linear(diffuse.g), linear(diffuse.b)});
  float shine = 0;
  material.Get(AI_MATKEY_SHININESS, shine);
  if (shine > 20) look.gloss = 0.04F, look.roughness = 0.3F;
  aiString name;
  if (material.GetTexture(aiTextureType_DIFFUSE, 0, &name) != AI_SUCCESS) return look;
  const cv::Mat picture = picture_of(archive.content(folder + name.C_Str()));
  if (picture.empty()) return look;  // still a shape
  look.pattern = Pattern::dead_leaves;
  look.period = {1, 1};
  look.image = texture_of(picture);
  return look;
}

}  // namespace

const std::vector<Model>& models_for(Use use) {
  static const std::vector<Model> fit = catalogue(std::string(kFolder) + "Scopia.sh3f");
  static const std::vector<Model> yardstick = catalogue(std::string(kFolder) + "BlendSwap-CC-0.sh3f");
  return use == Use::fit ? fit : yardstick;
}

bool has_photographs() {
  return std::filesystem::exists(file_of(kPhotographs.front()));
}

TextureImage photograph(Dice& dice) {
  static const std::vector<cv::Mat> all = photographs();
  if (all.empty()) return {};
  const cv::Mat& picture = dice.pick(all);
  const int side = static_cast<int>(draw(dice, 0.25, 1) * kPhotographSide);
  const int x = dice.below(picture.cols - side + 1), y = dice.below(picture.rows - side + 1);
  cv::Mat tile;  // beside and above its mirror images, so that the texture has no seams
  cv::copyMakeBorder(picture({x, y, side, side}), tile, 0, side, 0, side,
                     cv::BORDER_REFLECT | cv::BORDER_ISOLATED);
  return texture_of(tile);
}

ModelMesh mesh_of(const Model& model) {
  auto owned = std::make_unique<Archive>(model.file);
  const Archive& archive = *owned;
  Assimp::Importer importer;
  importer.SetIOHandler(owned.release());  // the importer deletes it
  std::string path = model.path;
  if (path.starts_with('/')) path.erase(0, 1);
  const aiScene* const scene = importer.ReadFile(
      path, aiProcess_Triangulate | aiProcess_JoinIdenticalVertices | aiProcess_PreTransformVertices);
  if (scene == nullptr) return {};
  const std::string folder = path.substr(0, path.rfind('/') + 1);
  // The four materials with most triangles get looks of their own.
  std::map<unsigned, std::size_t> triangles;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m)
    triangles[scene->mMeshes[m]->mMaterialIndex] += scene->mMeshes[m]->mNumFaces;
  std::vector<std::pair<std::size_t, unsigned>> by_count;
  for (const auto& [material, count] : triangles) by_count.emplace_back(count, material);
  std::ranges::sort(by_count, std::greater());
  ModelMesh made;
  std::map<unsigned, std::uint8_t> part_of;
  for (std::size_t k = 0; k < by_count.size(); ++k) {
    part_of[by_count[k].second] = static_cast<std::uint8_t>(std::min<std::size_t>(k, 3));
    if (k < 4) made.looks.at(k) = look_of(*scene->mMaterials[by_count[k].second], archive, folder);
  }
  Mesh& mesh = made.mesh;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& from = *scene->mMeshes[m];
    const auto first = static_cast<std::uint32_t>(mesh.points.size());
    for (unsigned i = 0; i < from.mNumVertices; ++i) {
      const aiVector3D p = from.mVertices[i];
      mesh.points.push_back({p.x, -p.z, p.y});  // y is up there
      const bool has_uv = from.HasTextureCoords(0);
      mesh.uv.push_back(has_uv ? Vec2{from.mTextureCoords[0][i].x, from.mTextureCoords[0][i].y}
                               : Vec2{p.x + p.z, p.y});
    }
    for (unsigned i = 0; i < from.mNumFaces; ++i) {
      const aiFace& face = from.mFaces[i];
      if (face.mNumIndices != 3) continue;
      mesh.triangles.push_back(
          {first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
      mesh.part.push_back(part_of[from.mMaterialIndex]);
    }
  }
  if (mesh.triangles.empty()) return {};
  const auto [low, high] = bounds(mesh);
  const auto factor = [](float wanted, float from) { return from > 1e-6F ? wanted / from : 1; };
  mesh =
      scaled(std::move(mesh), {factor(model.size_m.x, high.x - low.x), factor(model.size_m.y, high.y - low.y),
                               factor(model.size_m.z, high.z - low.z)});
  settle(mesh);
  return made;
}

}  // namespace cairn::worlds
