// SPDX-License-Identifier: BSD-3-Clause
#include "RayScene.h"

#include <stdexcept>

namespace dyslam::sim
{
RayDevice::RayDevice() : device_(rtcNewDevice("isa=avx2"))
{
  if (device_ == nullptr)
  {
    device_ = rtcNewDevice(nullptr);
  }
  if (device_ == nullptr)
  {
    throw std::runtime_error("cannot create an Embree device");
  }
}

RayDevice::~RayDevice()
{
  rtcReleaseDevice(device_);
}

RayScene::RayScene(RTCDevice device) : device_(device), scene_(rtcNewScene(device))
{
  rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
}

RayScene::~RayScene()
{
  if (scene_ != nullptr)
  {
    rtcReleaseScene(scene_);
  }
}

RayScene::RayScene(RayScene&& other) noexcept
    : device_(other.device_),
      scene_(std::exchange(other.scene_, nullptr)),
      items_(std::move(other.items_))
{
}

void RayScene::addMesh(const Mesh& mesh, const SceneItem& item)
{
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_QUAD);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                               RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                               mesh.vertices.size()));
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
  {
    Eigen::Map<Eigen::Vector3f>(vertices + 3 * i) = mesh.vertices[i];
  }
  auto* quads = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4,
                              4 * sizeof(std::uint32_t), mesh.quads.size()));
  for (std::size_t i = 0; i < mesh.quads.size(); ++i)
  {
    std::copy(mesh.quads[i].begin(), mesh.quads[i].end(), quads + 4 * i);
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene_, geometry, static_cast<unsigned>(items_.size()));
  rtcReleaseGeometry(geometry);
  items_.push_back(item);
  items_.back().mesh = &mesh;
}

void RayScene::addInstance(const RayScene& shape,
                           const Eigen::Affine3f& start,
                           const Eigen::Affine3f* end,
                           const SceneItem& item)
{
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(geometry, shape.handle());
  const auto set = [&](unsigned step, const Eigen::Affine3f& transform)
  {
    const Eigen::Matrix<float, 3, 4> rows = transform.matrix().topRows<3>();
    rtcSetGeometryTransform(geometry, step, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, rows.data());
  };
  rtcSetGeometryTimeStepCount(geometry, end != nullptr ? 2 : 1);
  set(0, start);
  if (end != nullptr)
  {
    set(1, *end);
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene_, geometry, static_cast<unsigned>(items_.size()));
  rtcReleaseGeometry(geometry);
  items_.push_back(item);
  items_.back().mesh = shape.items().front().mesh;
  items_.back().turn = start.linear();
}

void RayScene::commit(RTCBuildQuality quality)
{
  rtcSetSceneBuildQuality(scene_, quality);
  rtcCommitScene(scene_);
}

void RayScene::clear()
{
  for (std::size_t i = 0; i < items_.size(); ++i)
  {
    rtcDetachGeometry(scene_, static_cast<unsigned>(i));
  }
  items_.clear();
}
}  // namespace dyslam::sim
