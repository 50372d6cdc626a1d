// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "lab/worlds/render.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "lab/worlds/dice.hpp"
#include "lab/worlds/shapes.hpp"

namespace cairn::worlds {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr float kOffset = 2e-4F;  // m, by which a ray leaves the surface that it starts on
constexpr float kSmooth = 0.77F;  // cosine: at sharper creases, normals are not interpolated
constexpr float kBlocked =
    0.35F;  // of the ambient light, where something near is in its way: it reflects some
constexpr float kMinReflection = 0.02F;
constexpr int kWindow = 2;  // px, around a pixel, over which soft light is smoothed
constexpr float kSameNormal = 0.95F;
constexpr float kSamePlane = 0.2F;  // of the distance between two points of one surface

Vec3 times(Vec3 a, Vec3 b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}

/// The point on the unit hemisphere around n that belongs to (u, v), cosine-weighted.
Vec3 around(Vec3 n, float u, float v) {
  const Vec3 t = unit(std::abs(n.z) < 0.9F ? cross(kZ, n) : cross(kX, n));
  const Vec3 b = cross(n, t);
  const float r = std::sqrt(u);
  return unit(r * std::cos(2 * kPi * v) * t + r * std::sin(2 * kPi * v) * b + std::sqrt(1 - u) * n);
}

struct Hit {
  const Body* body = nullptr;  // nullptr: the sky
  std::uint32_t triangle = 0;
  float u = 0;
  float v = 0;
  float distance = kFar;
  Vec3 point;
  Vec3 normal;     // towards the ray's origin
  Vec3 geometric;  // the triangle's, likewise
};

/// The scene in Embree's tree.
class Tracer {
 public:
  explicit Tracer(const Scene& scene)
      : scene_(scene), device_(rtcNewDevice("threads=1")), tree_(rtcNewScene(device_)) {
    rtcSetSceneBuildQuality(tree_, RTC_BUILD_QUALITY_MEDIUM);
    rtcSetSceneFlags(tree_, RTC_SCENE_FLAG_ROBUST);
    for (const Body& body : scene.bodies) add(body.mesh);
    rtcCommitScene(tree_);
  }
  Tracer(const Tracer&) = delete;
  Tracer& operator=(const Tracer&) = delete;
  ~Tracer() {
    rtcReleaseScene(tree_);
    rtcReleaseDevice(device_);
  }

  [[nodiscard]] Hit hit(Vec3 from, Vec3 direction) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit ray{};
    ray.ray = ray_of(from, direction, kFar);
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(tree_, &context, &ray);
    Hit found;
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return found;
    found.body = &scene_.bodies[ray.hit.geomID];
    found.triangle = ray.hit.primID;
    found.u = ray.hit.u;
    found.v = ray.hit.v;
    found.distance = ray.ray.tfar;
    found.point = from + ray.ray.tfar * direction;
    Vec3 geometric = unit({ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z});
    Vec3 normal = interpolated(ray.hit.geomID, ray.hit.primID, found.u, found.v, geometric);
    if (dot(geometric, direction) > 0) geometric = -1 * geometric, normal = -1 * normal;
    found.geometric = geometric;
    found.normal = dot(normal, direction) < 0 ? normal : geometric;
    return found;
  }
  [[nodiscard]] bool is_free(Vec3 from, Vec3 direction, float reach) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay ray = ray_of(from, direction, reach);
    rtcOccluded1(tree_, &context, &ray);
    return ray.tfar > 0;
  }

 private:
  static RTCRay ray_of(Vec3 from, Vec3 direction, float reach) {
    RTCRay ray{};
    ray.org_x = from.x, ray.org_y = from.y, ray.org_z = from.z;
    ray.dir_x = direction.x, ray.dir_y = direction.y, ray.dir_z = direction.z;
    ray.tnear = 0;
    ray.tfar = reach;
    ray.mask = 0xFFFFFFFFU;
    return ray;
  }

  void add(const Mesh& mesh) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    // Embree reads 16 bytes at each point, so it gets buffers of its own.
    auto* const points = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.points.size()));
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
      points[3 * i] = mesh.points[i].x, points[3 * i + 1] = mesh.points[i].y,
                 points[3 * i + 2] = mesh.points[i].z;
    }
    auto* const corners = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(std::uint32_t), mesh.triangles.size()));
    std::vector<Vec3> sums(mesh.points.size());
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const auto& t = mesh.triangles[i];
      std::copy(t.begin(), t.end(), corners + 3 * i);
      const Vec3 twice_area =
          cross(mesh.points[t[1]] - mesh.points[t[0]], mesh.points[t[2]] - mesh.points[t[0]]);
      for (const std::uint32_t corner : t) sums[corner] = sums[corner] + twice_area;
    }
    for (Vec3& sum : sums) sum = unit(sum);
    normals_.push_back(std::move(sums));
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(tree_, geometry);
    rtcReleaseGeometry(geometry);
  }

  [[nodiscard]] Vec3 interpolated(std::size_t body, std::uint32_t triangle, float u, float v,
                                  Vec3 geometric) const {
    const auto& t = scene_.bodies[body].mesh.triangles[triangle];
    const auto& n = normals_[body];
    const Vec3 sum = (1 - u - v) * n[t[0]] + u * n[t[1]] + v * n[t[2]];
    const Vec3 smooth = unit(sum);
    return dot(smooth, geometric) > kSmooth ? smooth : geometric;
  }

  const Scene& scene_;
  RTCDevice device_;
  RTCScene tree_;
  std::vector<std::vector<Vec3>> normals_;  // of the points of each body
};

/// Random numbers of one of a pixel's samples. Those that choose a light's point fill their square evenly over the
/// samples (the R2 sequence, Roberts 2018), from a start that differs from pixel to pixel.
struct Draws {
  Dice dice;
  Vec2 start;
  int sample = 0;

  [[nodiscard]] Vec2 even(int which) const {
    const float k = static_cast<float>(sample) + 0.37F * static_cast<float>(which);
    const float x = start.x + 0.7548777F * k + 0.31F * static_cast<float>(which);
    const float y = start.y + 0.5698403F * k + 0.73F * static_cast<float>(which);
    return {x - std::floor(x), y - std::floor(y)};
  }
};

/// What a ray brings back. `soft` is the light of lamps and surroundings on a point; few rays make it noisy.
struct Seen {
  const Body* body = nullptr;  // nullptr: nothing to smooth
  Vec3 point;
  Vec3 normal;
  Vec3 soft;  // seen times `albedo`
  Vec3 albedo;
  Vec3 rest;  // the sun's light, mirrored light, what shines
};

/// Light along rays.
class Light {
 public:
  Light(const Scene& scene, const Tracer& tracer) : scene_(scene), tracer_(tracer) {}

  [[nodiscard]] Seen along(Vec3 from, Vec3 direction, Draws& draws, bool reflects = true) const {
    const Hit hit = tracer_.hit(from, direction);
    Seen seen;
    if (hit.body == nullptr) {
      seen.rest = mix(scene_.sky_low, scene_.sky_high, std::clamp(2 * direction.z, 0.0F, 1.0F));
      return seen;
    }
    const Surface surface = surface_of(hit);
    if (hit.body->is_bright) {
      seen.rest = 3 * surface.albedo;
      return seen;
    }
    const Vec3 at = hit.point + kOffset * hit.geometric;
    seen.body = hit.body, seen.point = hit.point, seen.normal = hit.normal, seen.albedo = surface.albedo;
    const auto [soft, hard] = falling_on(at, hit.normal, draws);
    seen.soft = soft, seen.rest = times(surface.albedo, hard);
    if (scene_.has_projector) seen.rest = seen.rest + projected_on(at, hit.normal) * surface.albedo;
    if (!reflects || surface.gloss <= 0) return seen;
    // Schlick's approximation; a rough surface mirrors less clearly.
    const float grazing = 1 + dot(direction, hit.normal);
    const float share =
        surface.gloss + (1 - surface.gloss) * std::pow(std::max(grazing, 0.0F), 5.0F) * surface.gloss * 4;
    const float mirrored = std::min(share, 0.95F) * (1 - surface.roughness);
    if (mirrored < kMinReflection) return seen;
    const Vec3 mirror = direction - 2 * dot(direction, hit.normal) * hit.normal;
    const float spread = surface.roughness * surface.roughness;
    const float first = draw(draws.dice, 0, 1);
    const Vec3 scattered = unit(mirror + spread * around(hit.normal, first, draw(draws.dice, 0, 1)));
    const Seen behind = along(at, scattered, draws, false);
    seen.albedo = (1 - mirrored) * seen.albedo;
    seen.rest = (1 - mirrored) * seen.rest + mirrored * (times(behind.albedo, behind.soft) + behind.rest);
    return seen;
  }

 private:
  [[nodiscard]] Surface surface_of(const Hit& hit) const {
    const Body& body = *hit.body;
    const auto& t = body.mesh.triangles[hit.triangle];
    const float w = 1 - hit.u - hit.v;
    const auto& uv = body.mesh.uv;
    const Vec2 at{w * uv[t[0]].x + hit.u * uv[t[1]].x + hit.v * uv[t[2]].x,
                  w * uv[t[0]].y + hit.u * uv[t[1]].y + hit.v * uv[t[2]].y};
    const std::vector<Vec3>& own = body.own.empty() ? body.mesh.points : body.own;
    const Vec3 point = w * own[t[0]] + hit.u * own[t[1]] + hit.v * own[t[2]];
    return surface_at(body.looks.at(body.mesh.part[hit.triangle] & 3U), at, point);
  }

  /// The light of the projector's spots: as strong as the light from everywhere at 4 m.
  [[nodiscard]] float projected_on(Vec3 at, Vec3 normal) const {
    const Rig& rig = scene_.rig;
    const Vec3 from = at - rig.eye;
    const float z = dot(from, rig.forward);
    if (z <= 0) return 0;
    const float spot = spots_at({dot(from, rig.right) / z, dot(from, rig.down) / z});
    const Vec3 back = -1 * unit(from);
    const float facing = dot(normal, back);
    if (spot <= 0 || facing <= 0 || !tracer_.is_free(at, back, length(from) - kOffset)) return 0;
    const Vec3& around = scene_.ambient;
    return spot * facing * (around.x + around.y + around.z) / 3 * std::min(16 / dot(from, from), 16.0F);
  }

  /// What falls on a point: lamps with soft shadows and ambient light where nothing near blocks it; the sun.
  [[nodiscard]] std::array<Vec3, 2> falling_on(Vec3 at, Vec3 normal, const Draws& draws) const {
    Vec3 soft, hard;
    int which = 0;
    for (const Lamp& lamp : scene_.lamps) {
      const Vec2 drawn = draws.even(++which);
      const float across = drawn.x - 0.5F, along = drawn.y - 0.5F;
      const bool is_sun = lamp.size_m <= 0;
      Vec3 towards = lamp.at + Vec3{lamp.size_m * across, lamp.size_m * along, 0} - at;
      float fading = 1;
      float reach = kFar;
      if (is_sun) {
        towards = lamp.at + Vec3{0.004F * across, 0.004F * along, 0};  // its disc
      } else {
        reach = length(towards);
        fading = std::max(unit(towards).z, 0.05F) / (reach * reach);
      }
      const Vec3 direction = unit(towards);
      const float facing = dot(normal, direction);
      if (facing <= 0 || !tracer_.is_free(at, direction, reach - kOffset)) continue;
      Vec3& sum = is_sun ? hard : soft;
      sum = sum + facing * fading * lamp.power;
    }
    const Vec2 drawn = draws.even(0);
    const bool is_free = tracer_.is_free(at, around(normal, drawn.x, drawn.y), scene_.reach_m);
    return {soft + (is_free ? 1.0F : kBlocked) * scene_.ambient, hard};
  }

  const Scene& scene_;
  const Tracer& tracer_;
};

Vec3 direction_of(const Rig& rig, float x, float y) {
  return rig.forward + (x - rig.cx_px) / rig.focal_px * rig.right + (y - rig.cy_px) / rig.focal_px * rig.down;
}

/// The soft light at a sample: the mean over the samples of the same number on the same surface, in a window
/// around its pixel. `seen`: pixel by pixel.
Vec3 smoothed(const std::vector<Seen>& seen, Size size, int x, int y, std::size_t which,
              std::size_t per_pixel) {
  const auto at = [&](int column, int row) -> const Seen& {
    return seen[static_cast<std::size_t>(row * size.width + column) * per_pixel + which];
  };
  const Seen& here = at(x, y);
  Vec3 sum;
  float count = 0;
  for (int row = std::max(y - kWindow, 0); row <= std::min(y + kWindow, size.height - 1); ++row) {
    for (int column = std::max(x - kWindow, 0); column <= std::min(x + kWindow, size.width - 1); ++column) {
      const Seen& there = at(column, row);
      if (there.body != here.body || dot(there.normal, here.normal) < kSameNormal) continue;
      const Vec3 apart = there.point - here.point;
      if (std::abs(dot(apart, here.normal)) > kSamePlane * length(apart)) continue;
      sum = sum + there.soft;
      ++count;
    }
  }
  return 1 / count * sum;
}

Picture picture_of(const Scene& scene, const Tracer& tracer, bool is_right, int samples) {
  const Rig& rig = scene.rig;
  const Light light(scene, tracer);
  const Vec3 eye = is_right ? rig.eye + rig.baseline_m * rig.right : rig.eye;
  const float rows = is_right ? rig.right_row_offset_px : 0;
  Picture picture{rig.size, std::vector<Vec3>(static_cast<std::size_t>(rig.size.area()))};
  const int strata = std::max(1, static_cast<int>(std::lround(std::sqrt(samples))));
  const auto per_pixel = static_cast<std::size_t>(strata * strata);
  std::vector<Seen> seen;
  seen.reserve(per_pixel * picture.colour.size());
  std::uint64_t at = 0;
  for (int y = 0; y < rig.size.height; ++y) {
    for (int x = 0; x < rig.size.width; ++x, ++at) {
      Dice dice = Dice(scene.seed).fork(2 * at + (is_right ? 1 : 0));
      Draws draws{dice, {draw(dice, 0, 1), draw(dice, 0, 1)}};
      draws.dice = dice.fork(1);
      for (int k = 0; k < strata * strata; ++k) {
        draws.sample = k;
        const float dx = fraction(k % strata, strata) + draw(dice, 0, 1.0 / strata) - 0.5F;
        const float dy = fraction(k / strata, strata) + draw(dice, 0, 1.0 / strata) - 0.5F;
        const Vec3 direction =
            unit(direction_of(rig, static_cast<float>(x) + dx, static_cast<float>(y) + dy - rows));
        seen.push_back(light.along(eye, direction, draws));
      }
    }
  }
  at = 0;
  for (int y = 0; y < rig.size.height; ++y) {
    for (int x = 0; x < rig.size.width; ++x, ++at) {
      Vec3 sum;
      for (std::size_t k = 0; k < per_pixel; ++k) {
        const Seen& one = seen[at * per_pixel + k];
        Vec3 c = one.rest;
        if (one.body != nullptr) c = c + times(one.albedo, smoothed(seen, rig.size, x, y, k, per_pixel));
        // A lamp in a mirror must not outshine its neighbours by itself.
        sum = sum + Vec3{std::min(c.x, 8.0F), std::min(c.y, 8.0F), std::min(c.z, 8.0F)};
      }
      picture.colour[at] = (1.0F / static_cast<float>(per_pixel)) * sum;
    }
  }
  return picture;
}

Truth truth_of(const Scene& scene, const Tracer& tracer) {
  const Rig& rig = scene.rig;
  Truth truth{Image<std::uint8_t>(rig.size, 0, {}), Image<float>(rig.size, 0, {}),
              Image<std::uint8_t>(rig.size, 255, {}), Image<std::uint8_t>(rig.size, 0, {})};
  const Vec3 right_eye = rig.eye + rig.baseline_m * rig.right;
  for (int y = 0; y < rig.size.height; ++y) {
    for (int x = 0; x < rig.size.width; ++x) {
      const Vec3 direction = direction_of(rig, static_cast<float>(x), static_cast<float>(y));
      const Hit hit = tracer.hit(rig.eye, direction);
      if (hit.body == nullptr) {  // the sky is infinitely far
        truth.occlusion(x, y) = 0;
        continue;
      }
      const float d = rig.focal_px * rig.baseline_m / hit.distance;  // the direction's depth is 1
      truth.ids(x, y) = static_cast<std::uint8_t>(hit.body->id);
      truth.disparity_px(x, y) = d;
      truth.ground(x, y) = hit.body->is_ground ? 255 : 0;
      const float x_right = static_cast<float>(x) - d;
      if (x_right < -0.5F) continue;
      const Vec3 back = right_eye - hit.point;
      const Vec3 towards = unit(back);
      const bool faces = dot(towards, hit.geometric) > 0;
      const float slack = 1e-3F * hit.distance;  // so that no surface hides itself
      if (faces && tracer.is_free(hit.point + slack * towards, towards, length(back) - slack))
        truth.occlusion(x, y) = 0;
    }
  }
  return truth;
}

}  // namespace

Rendered render(const Scene& scene, int samples) {
  const Tracer tracer(scene);
  return {picture_of(scene, tracer, false, samples), picture_of(scene, tracer, true, samples),
          truth_of(scene, tracer)};
}

Truth truth_of(const Scene& scene) {
  return truth_of(scene, Tracer(scene));
}

Image<Rgb> expose(const Picture& picture, const Sensor& sensor, bool is_right, std::uint64_t seed) {
  cv::Mat values(picture.size.height, picture.size.width, CV_32FC3);
  const float middle_x = static_cast<float>(picture.size.width - 1) / 2;
  const float middle_y = static_cast<float>(picture.size.height - 1) / 2;
  std::size_t at = 0;
  for (int y = 0; y < picture.size.height; ++y) {
    auto* const row = values.ptr<cv::Vec3f>(y);
    for (int x = 0; x < picture.size.width; ++x, ++at) {
      const float u = (static_cast<float>(x) - middle_x) / middle_x;
      const float v = (static_cast<float>(y) - middle_y) / middle_x;
      const Vec3 c = sensor.exposure * (1 - sensor.vignetting * (u * u + v * v)) * picture.colour[at];
      row[x] = sensor.is_grey ? cv::Vec3f::all(dot(c, sensor.grey_weights)) : cv::Vec3f(c.z, c.y, c.x);
    }
  }
  if (sensor.blur_px > 0.1F) cv::GaussianBlur(values, values, {}, sensor.blur_px);
  Dice dice = Dice(seed).fork(is_right ? 1 : 0);
  cv::Mat bytes(values.size(), CV_8UC3);
  for (int y = 0; y < values.rows; ++y) {
    for (int x = 0; x < values.cols; ++x) {
      auto& out = bytes.at<cv::Vec3b>(y, x);
      double noise = dice.normal();
      for (int k = 0; k < 3; ++k) {
        const double light = std::clamp(double{values.at<cv::Vec3f>(y, x)[k]}, 0.0, 1.0);
        if (k > 0 && !sensor.is_grey) noise = dice.normal();
        const double sigma = std::sqrt(light * double{sensor.shot_noise} * double{sensor.shot_noise} +
                                       double{sensor.read_noise} * double{sensor.read_noise});
        double value = std::pow(std::clamp(light + sigma * noise, 0.0, 1.0), 1 / double{sensor.gamma});
        if (is_right) value = value * double{sensor.right_gain} + double{sensor.right_offset};
        out[k] = static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0)));
      }
    }
  }
  Image<Rgb> image(picture.size);
  for (int y = 0; y < bytes.rows; ++y) {
    for (int x = 0; x < bytes.cols; ++x) {
      const auto& c = bytes.at<cv::Vec3b>(y, x);
      image(x, y) = {c[2], c[1], c[0]};
    }
  }
  return image;
}

}  // namespace cairn::worlds
