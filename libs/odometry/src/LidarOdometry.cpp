// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/odometry/LidarOdometry.h>

#include "DyloOptions.h"
#include "GicpOdometry.h"
#include "IcpOdometry.h"
#include "LoamOdometry.h"
#include "SimpleOdometry.h"
#ifdef DYSLAM_HAVE_TORCH
#include "DyloOdometry.h"
#endif

namespace dyslam
{
namespace
{
std::unique_ptr<LidarOdometry> makeDylo([[maybe_unused]] const DyloOptions& options)
{
#ifdef DYSLAM_HAVE_TORCH
  return std::make_unique<DyloOdometry>(options);
#else
  throw UserError(
      "odometry.method: dylo needs a build with libtorch; use constant_velocity or loam, or "
      "install "
      "libtorch-dev and build again");
#endif
}
}  // namespace

const std::vector<float>& LidarOdometry::staticConfidence() const
{
  static const std::vector<float> none;
  return none;
}

std::vector<std::string> odometryMethods()
{
  return {"constant_velocity", "zero_motion", "icp_po2po", "icp_po2pl", "gicp",
          "loam_no_mapping",   "loam",        "dylo"};
}

std::unique_ptr<LidarOdometry> makeOdometry(const std::string& method,
                                            ConfigLoader& loader,
                                            ThreadPool& pool)
{
  if (method == "constant_velocity")
  {
    return std::make_unique<SimpleOdometry>(SimpleOdometry::Kind::constant_velocity);
  }
  if (method == "zero_motion")
  {
    return std::make_unique<SimpleOdometry>(SimpleOdometry::Kind::zero_motion);
  }
  if (method == "icp_po2po")
  {
    return std::make_unique<IcpOdometry>(IcpOdometry::Residual::point_to_point,
                                         loader.get<IcpPointToPointOptions>(method), pool);
  }
  if (method == "icp_po2pl")
  {
    return std::make_unique<IcpOdometry>(IcpOdometry::Residual::point_to_plane,
                                         loader.get<IcpOptions>(method), pool);
  }
  if (method == "gicp")
  {
    return std::make_unique<GicpOdometry>(loader.get<GicpOptions>(method), pool);
  }
  if (method == "loam" || method == "loam_no_mapping")
  {
    return std::make_unique<LoamOdometry>(method == "loam", loader.get<LoamOptions>(method), pool);
  }
  if (method == "dylo")
  {
    return makeDylo(loader.get<DyloOptions>(method));
  }
  const std::string nearest = nearestWord(method, odometryMethods());
  throw UserError("odometry.method: unknown method '" + method + "'" +
                  (nearest.empty() ? std::string() : "; did you mean '" + nearest + "'?"));
}
}  // namespace dyslam
