// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <embree3/rtcore.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "shapes/Mesh.h"

namespace dyslam::sim
{
/** An object in a ray-tracing scene: a mesh of the world or an instance of a shape. */
struct SceneItem
{
  const Mesh* mesh = nullptr;
  std::uint16_t semantic = 0;  //!< SemanticKITTI class, if the material has none
  std::uint16_t instance = 0;  //!< instance in the labels; 0 for none
  float reflectivity = -1;     //!< reflectivity of paint and cloth; negative: that of the material
  std::int32_t body = -1;      //!< index of a moving body, else -1
  std::int32_t part = 0;       //!< index of the body's part
  Eigen::Matrix3f turn = Eigen::Matrix3f::Identity();  //!< rotation of an instance, for its normals
};

/** Owns an Embree scene with the properties of its objects. Immutable and thread-safe after
 * commit(). */
class RayScene
{
 public:
  explicit RayScene(RTCDevice device);
  ~RayScene();
  RayScene(RayScene&& other) noexcept;
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;
  RayScene& operator=(RayScene&&) = delete;

  /** `mesh` must outlive the scene, whose items refer to its materials. */
  void addMesh(const Mesh& mesh, const SceneItem& item);
  /** An instance of a shape at `start`, or moving from `start` to `end` over ray times 0 to 1. */
  void addInstance(const RayScene& shape,
                   const Eigen::Affine3f& start,
                   const Eigen::Affine3f* end,
                   const SceneItem& item);
  void commit(RTCBuildQuality quality);
  void clear();

  [[nodiscard]] RTCScene handle() const { return scene_; }
  [[nodiscard]] const std::vector<SceneItem>& items() const { return items_; }
  [[nodiscard]] bool empty() const { return items_.empty(); }

 private:
  RTCDevice device_;
  RTCScene scene_;
  std::vector<SceneItem> items_;
};

/** Embree device restricted to AVX2, so that results do not depend on further extensions of the
 * processor; Embree's default on processors without AVX2. */
class RayDevice
{
 public:
  RayDevice();
  ~RayDevice();
  RayDevice(const RayDevice&) = delete;
  RayDevice& operator=(const RayDevice&) = delete;
  [[nodiscard]] RTCDevice handle() const { return device_; }

 private:
  RTCDevice device_;
};
}  // namespace dyslam::sim
