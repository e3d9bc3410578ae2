// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/train/RecordingPairSource.h>

#include <algorithm>

namespace dyslam
{
RecordingPairSource::RecordingPairSource(std::vector<Recording> recordings,
                                         std::vector<Body> bodies,
                                         const AugmentationOptions& augmentation,
                                         int max_gap,
                                         std::uint64_t seed)
    : recordings_(std::move(recordings)),
      bodies_(std::move(bodies)),
      augmentation_(augmentation),
      max_gap_(max_gap),
      seed_(seed)
{
  if (recordings_.empty())
  {
    throw UserError("recordings: none given");
  }
  for (const Recording& recording : recordings_)
  {
    if (recording.scans.size() < 2)
    {
      throw UserError("recording " + recording.name + ": at least two scans are needed");
    }
  }
}

TrainingPair RecordingPairSource::pair(std::uint64_t index) const
{
  RandomDraws draws(seed_, index);
  std::size_t total = 0;
  for (const Recording& recording : recordings_)
  {
    total += recording.scans.size();
  }
  std::size_t scan = draws.below(total);
  std::size_t chosen = 0;
  while (scan >= recordings_[chosen].scans.size())
  {
    scan -= recordings_[chosen].scans.size();
    ++chosen;
  }
  const Recording& recording = recordings_[chosen];
  // Steps of one scan are the usual case of odometry.
  const std::size_t last = recording.scans.size() - 1;
  const std::size_t drawn =
      draws.chance(0.45) ? 1 : 1 + draws.below(static_cast<std::size_t>(max_gap_));
  const std::size_t gap = std::min(drawn, last);
  bool forward = draws.chance(0.7);
  if (forward ? scan < gap : scan + gap > last)
  {
    forward = !forward;
  }
  // Near the middle of a short recording the gap may exceed it in both directions.
  const std::size_t other = forward ? scan - std::min(gap, scan) : std::min(scan + gap, last);

  TrainingPair pair;
  pair.points1 = recording.scans[scan];
  pair.points2 = recording.scans[other];
  if (!recording.labels.empty())
  {
    pair.labels1 = recording.labels[scan];
  }
  pair.T_2_1 = recording.T_world_scan[other].inverse() * recording.T_world_scan[scan];
  augment(augmentation_, bodies_, draws, pair);
  return pair;
}

SingleScanSource::SingleScanSource(std::vector<std::vector<Eigen::Vector3f>> scans,
                                   std::vector<Body> bodies,
                                   const AugmentationOptions& augmentation,
                                   std::uint64_t seed)
    : scans_(std::move(scans)), bodies_(std::move(bodies)), augmentation_(augmentation), seed_(seed)
{
  if (scans_.empty())
  {
    throw UserError("single scans: none given");
  }
}

TrainingPair SingleScanSource::pair(std::uint64_t index) const
{
  RandomDraws draws(seed_ ^ 0x51461EULL, index);
  const std::vector<Eigen::Vector3f>& scan = scans_[draws.below(scans_.size())];
  TrainingPair pair;
  const auto [y, z, yaw, pitch, roll] = draws.normals<5>({0.05, 0.02, 0.02, 0.005, 0.005});
  pair.T_2_1 = poseFromYpr(draws.uniform(-0.5, 2.5), y, z, yaw, pitch, roll);
  const Eigen::Isometry3f T_1_2 = pair.T_2_1.inverse().cast<float>();
  pair.points1.reserve(scan.size());
  pair.points2.reserve(scan.size());
  for (const Eigen::Vector3f& p : scan)
  {
    const double lot = draws.uniform();
    if (lot < 0.6)
    {
      pair.points1.push_back(T_1_2 * p);
    }
    if (lot > 0.4)
    {
      pair.points2.push_back(p);
    }
  }
  augment(augmentation_, bodies_, draws, pair);
  return pair;
}
}  // namespace dyslam
