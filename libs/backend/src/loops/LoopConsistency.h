// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/FactorGraph.h>

#include <set>

namespace dyslam
{
/** Used loops whose squared whitened residual at the present values is above 2 loss_width^2, more
 * than noise explains. */
[[nodiscard]] std::set<FactorGraph::FactorId> inconsistentLoops(const FactorGraph& graph,
                                                                double loss_width);

/** Number of groups of neighbouring loops: each group is one piece of evidence, since confusing two
 * places usually makes several false loops. */
[[nodiscard]] std::size_t independentGroups(const FactorGraph& graph,
                                            const std::set<FactorGraph::FactorId>& loops);

/** The group of neighbouring used loops that odometry, the other loops and localisations in a prior
 * map contradict most; empty if none is contradicted. A group is contradicted if without it chi2
 * falls, per loop of the group, by more than 2 loss_width^2 times the remaining variance per degree
 * of freedom (at least 1). Odometry alone contradicts nothing.
 *
 * A false loop distorts the odometry until it fits, so that its own residual does not reveal it.
 * Computed by linearisation at the present values, which are at or near the optimum, with ego poses
 * and the prior map only, and without the loops of inconsistentLoops() and localisations that do
 * not fit by the same limit.
 * \param odometry_sigma_scale factor on the odometry's sigmas */
[[nodiscard]] std::set<FactorGraph::FactorId> contradictedLoops(const FactorGraph& graph,
                                                                double loss_width,
                                                                double odometry_sigma_scale);
}  // namespace dyslam
