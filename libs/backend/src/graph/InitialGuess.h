// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "GraphData.h"

namespace dyslam
{
/** Initialises nodes without a pose by chaining the fewest edges from a node with a pose. */
void completePoses(GraphData& data);

/** Chordal initialisation: the rotations are the linear least-squares solution in the space of all
 * 3x3 matrices, projected onto rotations; the translations then follow from a linear system
 * (Martinec & Pajdla 2007; Carlone et al., "Initialization techniques for 3D SLAM", ICRA 2015). */
void chordalPoses(GraphData& data);
}  // namespace dyslam
