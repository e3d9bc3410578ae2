// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/FactorGraph.h>

#include <set>

namespace dyslam
{
/** Those of the used loops whose squared whitened residual at the present values is above
 * 2 loss_width^2, beyond what noise explains. */
[[nodiscard]] std::set<FactorGraph::FactorId> inconsistentLoops(const FactorGraph& graph,
                                                                double loss_width);

/** Number of groups of neighbouring loops: each is one piece of evidence, since one mistake about a
 * place makes several loops. */
[[nodiscard]] std::size_t independentGroups(const FactorGraph& graph,
                                            const std::set<FactorGraph::FactorId>& loops);

/** Of the used loops, the group of neighbouring ones that odometry and the other loops contradict
 * most; empty if none is contradicted. A group is if chi2 falls without it, for each of its loops,
 * by more than 2 loss_width^2 times the variance per degree of freedom that is left (1 at least).
 * Nothing is contradicted by odometry alone.
 *
 * A false loop distorts the odometry until it fits, so that its own residual does not reveal it.
 * Computed about the present values, at or near their optimum, on the ego poses alone, and without
 * the loops of inconsistentLoops().
 * \param odometry_sigma_scale factor on the odometry's sigmas */
[[nodiscard]] std::set<FactorGraph::FactorId> contradictedLoops(const FactorGraph& graph,
                                                                double loss_width,
                                                                double odometry_sigma_scale);
}  // namespace dyslam
