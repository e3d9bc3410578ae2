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
  // Every method's section is known, whichever is chosen: one ini serves all.
  const auto po2po = loader.get<IcpPointToPointOptions>("icp_po2po");
  const auto po2pl = loader.get<IcpOptions>("icp_po2pl");
  const auto gicp = loader.get<GicpOptions>("gicp");
  const auto loam = loader.get<LoamOptions>("loam");
  const auto loam_no_mapping = loader.get<LoamOptions>("loam_no_mapping");
  const auto dylo = loader.get<DyloOptions>("dylo");
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
    return std::make_unique<IcpOdometry>(IcpOdometry::Residual::point_to_point, po2po, pool);
  }
  if (method == "icp_po2pl")
  {
    return std::make_unique<IcpOdometry>(IcpOdometry::Residual::point_to_plane, po2pl, pool);
  }
  if (method == "gicp")
  {
    return std::make_unique<GicpOdometry>(gicp, pool);
  }
  if (method == "loam")
  {
    return std::make_unique<LoamOdometry>(true, loam, pool);
  }
  if (method == "loam_no_mapping")
  {
    return std::make_unique<LoamOdometry>(false, loam_no_mapping, pool);
  }
  if (method == "dylo")
  {
    return makeDylo(dylo);
  }
  const std::string nearest = nearestWord(method, odometryMethods());
  throw UserError("odometry.method: unknown method '" + method + "'" +
                  (nearest.empty() ? std::string() : "; did you mean '" + nearest + "'?"));
}
}  // namespace dyslam
