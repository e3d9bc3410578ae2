// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace mrpt
{
namespace containers
{
struct map_traits_stdmap;
}
namespace poses
{
class CPose3DPDFGaussianInf;
}
namespace graphs
{
namespace detail
{
struct TNodeAnnotationsEmpty;
struct edge_annotations_empty;
}  // namespace detail
template <class, class, class, class>
class CNetworkOfPoses;
}  // namespace graphs
}  // namespace mrpt

namespace dyslam
{
/** mrpt::graphs::CNetworkOfPoses3DInf, declared only; include <mrpt/graphs/CNetworkOfPoses.h> to
 * use it.
 *
 * Nodes are poses in the map, an edge i -> j measures T_i_j. Its information matrix is in MRPT's
 * coordinates, (x, y, z, yaw, pitch, roll) about the mean (see core/PoseInformation.h).
 */
using PoseGraph = mrpt::graphs::CNetworkOfPoses<mrpt::poses::CPose3DPDFGaussianInf,
                                                mrpt::containers::map_traits_stdmap,
                                                mrpt::graphs::detail::TNodeAnnotationsEmpty,
                                                mrpt::graphs::detail::edge_annotations_empty>;
}  // namespace dyslam
