// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/graphs/CNetworkOfPoses.h>

#include <string>
#include <vector>

namespace dyslam
{
/** Read a pose graph from a text file of MRPT's or TORO's `.graph` or of g2o's kind, told apart
 * line by line.
 *
 * | line | meaning of the information matrix (upper triangle, row by row) |
 * |---|---|
 * | `VERTEX3`, `EDGE3` | MRPT's: about x, y, z, roll, pitch, yaw of the measured pose |
 * | `VERTEX2`, `EDGE2` | TORO's: about x, y, heading h of it, in the order xx xy yy hh xh yh |
 * | `VERTEX_SE3:QUAT`, `EDGE_SE3:QUAT` | g2o's: about x, y, z and the quaternion's vector part |
 * | `VERTEX_SE2`, `EDGE_SE2` | g2o's: about x, y and heading in the frame of the measured pose |
 *
 * In the result every edge has MRPT's meaning: (x, y, z, yaw, pitch, roll) about the mean. Planar
 * lines are lifted: z, roll and pitch are measured as 0; z gets the mean information of x and y,
 * roll and pitch that of the heading. `FIX id` names the root; without it the lowest id is the
 * root. Nodes that only edges mention get no pose: nodes may be fewer than edges need. An edge
 * without an information matrix, as SC-LIO-SAM writes them, has the identity. `PARAMS_*` lines,
 * comments (#), empty lines and what follows a `|` are skipped.
 *
 * \param warnings a line about edges without an information matrix is appended, if given
 * \throws UserError naming file, line and field for anything else.
 */
[[nodiscard]] mrpt::graphs::CNetworkOfPoses3DInf readPoseGraph(
    const std::string& path, std::vector<std::string>* warnings = nullptr);

/** Write MRPT's `.graph`: what CNetworkOfPoses3DInf::saveToTextFile() writes, but with all digits;
 * `graph-slam --3d` and loadFromTextFile() read it. \throws UserError if the file cannot be
 * written. */
void writeGraph(const mrpt::graphs::CNetworkOfPoses3DInf& graph, const std::string& path);

/** Write `.g2o` (VERTEX_SE3:QUAT, FIX for the root, EDGE_SE3:QUAT) with the information converted
 * to g2o's coordinates. \throws UserError if the file cannot be written. */
void writeG2o(const mrpt::graphs::CNetworkOfPoses3DInf& graph, const std::string& path);
}  // namespace dyslam
