// SPDX-License-Identifier: BSD-3-Clause
#include "PoseGraphView.h"

#include <dyslam/backend/factors/LoopFactor.h>
#include <dyslam/backend/factors/OdometryFactor.h>
#include <dyslam/core/PoseInformation.h>
#include <dyslam/mrpt/Conversions.h>
#include <mrpt/graphs/CNetworkOfPoses.h>

namespace dyslam
{
PoseGraph poseGraphView(const FactorGraph& graph)
{
  PoseGraph view;
  for (const auto& [key, variable] : graph.variables())
  {
    if (key.kind == VariableKind::ego_pose)
    {
      static_cast<mrpt::poses::CPose3D&>(view.nodes[static_cast<std::size_t>(key.index)]) =
          toMrpt(unpackPose(variable.block.data()));
    }
  }
  for (const FactorGraph::FactorId id : graph.factorIds())
  {
    const Factor& factor = graph.factor(id);
    if (!graph.isLeftOut(id) && (factor.is<OdometryFactor>() || factor.is<LoopFactor>()))
    {
      const Pose T = factor.measurement();
      view.insertEdge(
          static_cast<std::size_t>(factor.keys()[0].index),
          static_cast<std::size_t>(factor.keys()[1].index),
          {toMrpt(T), mrpt::math::CMatrixDouble66(informationToYpr(T, factor.information()))});
    }
  }
  return view;
}
}  // namespace dyslam
