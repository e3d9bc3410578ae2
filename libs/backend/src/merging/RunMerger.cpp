// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/RunMerger.h>
#include <dyslam/backend/factors/LocalisationFactor.h>
#include <dyslam/backend/factors/LoopFactor.h>
#include <dyslam/backend/factors/OdometryFactor.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "RunMergerState.h"

namespace dyslam
{
void RunMergerOptions::describe(OptionsVisitor& visitor)
{
  visitor.real(
      "min_confirmed", min_confirmed, 0, 1,
      "least fraction of the keyframes near those of other runs that registrations confirm");
  visitor.flag("gnss", gnss, "use the satellite positions of the runs");
  visitor.flag("gravity", gravity, "use the verticals that the runs found by accelerations");
  visitor.flag("level_map", level_map,
               "rotate the merged map so that its z axis is vertical; also done if that of the "
               "first run was");
}

std::size_t RunMerger::State::runOf(std::size_t keyframe) const
{
  std::size_t run = 0;
  while (!runs[run].range.contains(keyframe))
  {
    ++run;
  }
  return run;
}

void RunMerger::State::findSeeds()
{
  for (std::size_t b = 1; b < runs.size(); ++b)
  {
    for (std::size_t a = 0; a < b; ++a)
    {
      seeds.push_back(findSeeds(a, b, true));
    }
  }
}

bool RunMerger::State::findSeedsAnywhere()
{
  bool any = false;
  for (Seeds& pair : seeds)
  {
    if (pair.nearby && !(runs[pair.run_a].joined && runs[pair.run_b].joined))
    {
      pair = findSeeds(pair.run_a, pair.run_b, false);
      any = true;
    }
  }
  return any;
}

std::vector<double> RunMerger::State::reachOf(const Run& run, const std::vector<Loop>& known) const
{
  std::vector<double> reach;
  for (std::size_t k = run.range.begin; k < run.range.end; ++k)
  {
    double path = known.empty() ? 0 : 1e9;
    for (const Loop& loop : known)
    {
      const std::size_t end = run.range.contains(loop.to) ? loop.to : loop.from;
      path = std::min(path, std::abs(keyframes[k].path_length - keyframes[end].path_length));
    }
    reach.push_back(searchRadius(config.loops, {path, 0}));
  }
  return reach;
}

NearLoops RunMerger::State::loopsAround(const Run& run, const std::vector<Loop>& known) const
{
  NearLoops all;
  const std::vector<double> reach = reachOf(run, known);
  for (const Run& other : runs)
  {
    if (!other.joined || other.range.begin == run.range.begin)
    {
      continue;
    }
    const NearLoops some = finder.byPosition(other.range, run.range, reach);
    all.accepted.insert(all.accepted.end(), some.accepted.begin(), some.accepted.end());
    all.tried += some.tried;
    all.confirmed += some.confirmed;
  }
  return all;
}

void RunMerger::State::solve()
{
  FactorGraph graph;
  for (const Run& run : runs)
  {
    for (std::size_t k = run.range.begin; run.joined && k < run.range.end; ++k)
    {
      graph.addPose(Key::ego(k), keyframes[k].T_map_vehicle);
    }
    for (const Edge& e : run.edges)
    {
      if (run.joined && e.is_loop)
      {
        graph.add(std::make_unique<LoopFactor>(e.from, e.to, e.T_from_to, e.information));
      }
      else if (run.joined)
      {
        graph.add(std::make_unique<OdometryFactor>(e.from, e.to, e.T_from_to, e.information));
      }
    }
  }
  addLocalisations(graph);
  graph.setFixed(Key::ego(0), runs.front().localisations.empty());
  std::vector<FactorGraph::FactorId> ids;
  for (const Loop& loop : loops)
  {
    ids.push_back(graph.add(
        std::make_unique<LoopFactor>(loop.from, loop.to, loop.T_from_to, loop.information)));
  }
  addReferences(graph);
  optimisation = graph.optimise(config.solver);
  const auto poseOf = [&graph](const Key& key)
  { return graph.contains(key) ? std::optional<Pose>(graph.pose(key)) : std::nullopt; };
  T_enu_map = poseOf(Key::georeference());
  T_level_map = poseOf(Key::vertical());
  false_loops.clear();
  for (std::size_t i = 0; i < ids.size(); ++i)
  {
    if (graph.isLeftOut(ids[i]))
    {
      false_loops.insert(i);
    }
  }
  std::vector<Pose> poses = keyframes.poses();
  for (const Run& run : runs)
  {
    for (std::size_t k = run.range.begin; run.joined && k < run.range.end; ++k)
    {
      poses[k] = graph.pose(Key::ego(k));
    }
  }
  keyframes.correct(poses);
}

bool RunMerger::State::join(const Placement& placement)
{
  Run& run = runs[placement.run];
  run.evidence.contradiction = contradictionOf(placement);
  if (run.evidence.contradiction)
  {
    return false;
  }
  const std::vector<Pose> before = keyframes.poses();
  const std::vector<Loop> joined_loops = loops;
  const std::set<std::size_t> joined_false = false_loops;
  const OptimisationResult joined_optimisation = optimisation;
  const std::optional<Pose> joined_on_earth = T_enu_map;
  const std::optional<Pose> joined_level = T_level_map;
  const auto solveWith = [&](const std::vector<Loop>& more)
  {
    loops = joined_loops;
    loops.insert(loops.end(), more.begin(), more.end());
    solve();
  };
  place(placement);
  run.joined = true;
  run.frame = placement.T_map_run ? placement.frame : placement.run;
  solveWith(placement.loops);
  // First with loops to places within the expected drift, then again at the resulting poses.
  solveWith(loopsAround(run, placement.loops).accepted);
  const NearLoops found = loopsAround(run, {});
  solveWith(found.accepted);
  const std::size_t added = found.accepted.size();
  const auto left_out = static_cast<std::size_t>(
      std::distance(false_loops.lower_bound(joined_loops.size()), false_loops.end()));
  run.evidence.placed = true;
  run.evidence.tried = found.tried;
  run.evidence.confirmed = found.confirmed;
  run.evidence.consistent = added - left_out;
  if (isConfirmed(placement, added))
  {
    return true;
  }
  run.joined = false;
  run.frame = placement.run;
  loops = joined_loops;
  false_loops = joined_false;
  optimisation = joined_optimisation;
  T_enu_map = joined_on_earth;
  T_level_map = joined_level;
  keyframes.correct(before);
  return false;
}

JoinEvidence RunMerger::State::evidenceOf(std::size_t run) const
{
  JoinEvidence evidence = runs[run].evidence;
  evidence.needed = static_cast<std::size_t>(config.loops.by_appearance.min_support) + 1;
  evidence.min_confirmed = config.merge.min_confirmed;
  for (const Seeds& pair : seeds)
  {
    if ((pair.run_a == run && runs[pair.run_b].joined) ||
        (pair.run_b == run && runs[pair.run_a].joined))
    {
      evidence.loops += pair.found;
    }
  }
  if (!runs[run].joined)
  {
    evidence.distance = distanceOnEarth(run);
  }
  return evidence;
}

RunMerge RunMerger::State::result() const
{
  RunMerge merge;
  merge.optimisation = optimisation;
  for (const Run& run : runs)
  {
    merge.evidence.push_back(evidenceOf(merge.poses.size()));
    merge.poses.emplace_back();
    for (std::size_t k = run.range.begin; run.joined && k < run.range.end; ++k)
    {
      merge.poses.back().push_back(keyframes[k].T_map_vehicle);
    }
  }
  fillReferences(merge);
  for (std::size_t i = 0; i < loops.size(); ++i)
  {
    RunLoop entry{runOf(loops[i].from), runOf(loops[i].to), loops[i], false_loops.count(i) != 0};
    const Pose T =
        keyframes[loops[i].from].T_map_vehicle.inverse() * keyframes[loops[i].to].T_map_vehicle;
    entry.residual = (loops[i].T_from_to.inverse() * T).translation().norm();
    entry.loop.from -= runs[entry.run_from].range.begin;
    entry.loop.to -= runs[entry.run_to].range.begin;
    merge.loops.push_back(std::move(entry));
  }
  return merge;
}

void RunMerger::State::Run::takeFactors(const FactorGraph& graph)
{
  for (const FactorGraph::FactorId id : graph.factorIds())
  {
    const Factor& factor = graph.factor(id);
    if (factor.is<OdometryFactor>() || (factor.is<LoopFactor>() && !graph.isLeftOut(id)))
    {
      edges.push_back({factor.is<LoopFactor>(),
                       range.begin + static_cast<std::size_t>(factor.keys()[0].index),
                       range.begin + static_cast<std::size_t>(factor.keys()[1].index),
                       factor.measurement(), factor.information()});
    }
    else if (factor.is<LocalisationFactor>())
    {
      localisations.push_back({range.begin + static_cast<std::size_t>(factor.keys()[1].index),
                               factor.measurement(), factor.information()});
    }
  }
}

RunMerger::RunMerger(const RunMergerConfig& config) : state_(std::make_unique<State>(config)) {}
RunMerger::~RunMerger() = default;
RunMerger::RunMerger(RunMerger&&) noexcept = default;
RunMerger& RunMerger::operator=(RunMerger&&) noexcept = default;

void RunMerger::addRun(const FactorGraph& graph, const RunReferences& references)
{
  State& s = *state_;
  State::Run run;
  run.range.begin = s.keyframes.size();
  if (s.ready != run.range.begin)
  {
    throw std::invalid_argument("RunMerger: keyframe " + std::to_string(s.ready) +
                                " of the runs before has no points yet");
  }
  Keyframe keyframe;
  for (std::size_t k = 0; graph.contains(Key::ego(k)); ++k)
  {
    const Pose pose = graph.pose(Key::ego(k));
    keyframe.path_length +=
        k == 0 ? 0 : (pose.translation() - keyframe.T_map_vehicle.translation()).norm();
    keyframe.frame = k;
    keyframe.T_map_vehicle = pose;
    s.keyframes.add(keyframe);
  }
  run.range.end = s.keyframes.size();
  run.takeFactors(graph);
  for (const auto& [key, variable] : graph.variables())
  {
    if (key.kind == VariableKind::ego_pose &&
        static_cast<std::size_t>(key.index) >= run.range.end - run.range.begin)
    {
      throw std::invalid_argument("RunMerger: the keyframes of the graph are not numbered 0, 1, 2");
    }
  }
  if (run.range.begin == run.range.end)
  {
    throw std::invalid_argument("RunMerger: the graph has no keyframe 0");
  }
  RunReferences used = references;
  if (!s.config.merge.gnss)
  {
    used.georeference.reset();
  }
  if (!s.config.merge.gravity)
  {
    used.gravity.reset();
  }
  run.anchor = RunAnchor(graph, used);
  run.T_own_middle = s.keyframes[run.middle()].T_map_vehicle;
  run.map_frame = references.map_frame;
  run.frame = s.runs.size();
  s.runs.push_back(std::move(run));
}

void RunMerger::addKeyframe(const std::vector<Eigen::Vector3f>& static_points)
{
  State& s = *state_;
  if (s.ready == s.keyframes.size())
  {
    throw std::invalid_argument("RunMerger: the run has no further keyframe");
  }
  s.finder.add(static_points);
  ++s.ready;
}

void RunMerger::State::joinAll()
{
  const auto next = [this] { return placementByFrame().value_or(bestPlacement()); };
  for (Placement p = next(); p.T_map_run || !p.loops.empty(); p = next())
  {
    if (!join(p))
    {
      refuse(p);
    }
  }
}

RunMerge RunMerger::merge()
{
  State& s = *state_;
  s.runs.front().joined = true;
  s.solve();
  s.findSeeds();
  s.joinAll();
  if (s.findSeedsAnywhere())  // loops that contradict satellite positions are reported
  {
    s.joinAll();
  }
  return s.result();
}
}  // namespace dyslam
