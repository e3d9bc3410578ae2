// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/FactorGraph.h>

#include <set>

namespace dyslam
{
/** Loop factors whose whitened residual at the present values is beyond what noise explains. */
[[nodiscard]] std::set<FactorGraph::FactorId> inconsistentLoops(
    const FactorGraph& graph, const std::set<FactorGraph::FactorId>& left_out, double loss_width);

/** Number of groups of neighbouring loops: each is one piece of evidence, since one mistake about a
 * place makes several loops. */
[[nodiscard]] std::size_t independentGroups(const FactorGraph& graph,
                                            const std::set<FactorGraph::FactorId>& loops);

/** Loops that are not left out. */
[[nodiscard]] std::set<FactorGraph::FactorId> keptLoops(
    const FactorGraph& graph, const std::set<FactorGraph::FactorId>& left_out);

/** The group of neighbouring loops that odometry and the other loops contradict most, if they do:
 * without it chi2 falls by more than 2 loss_width^2 for each of its loops, times the variance (of a
 * degree of freedom, 1 at least) that is left. Nothing is contradicted by odometry alone.
 *
 * A false loop distorts the odometry until it fits, so that its own residual does not reveal it.
 * Computed about the present values, at or near their optimum, on the ego poses alone, and without
 * the loops of inconsistentLoops().
 * \param left_out loops to ignore
 * \param odometry_sigma_scale factor on the odometry's sigmas */
[[nodiscard]] std::set<FactorGraph::FactorId> contradictedLoops(
    const FactorGraph& graph,
    const std::set<FactorGraph::FactorId>& left_out,
    double loss_width,
    double odometry_sigma_scale);
}  // namespace dyslam
