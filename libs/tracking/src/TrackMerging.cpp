// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/BoxOverlap.h>
#include <dyslam/tracking/TrackMerging.h>

#include <algorithm>
#include <tuple>
#include <utility>

namespace dyslam
{
namespace
{
using TrackPair = std::pair<int, int>;  // two ids, the smaller one first

/** Intersection of the footprints over the area of the smaller one. */
double sharedFootprint(const Box& a, const Box& b)
{
  const double reach = 0.5 * (a.size.head<2>().norm() + b.size.head<2>().norm());
  if ((a.centre - b.centre).head<2>().norm() > reach)
  {
    return 0;
  }
  const double area_a = a.size.x() * a.size.y();
  const double area_b = b.size.x() * b.size.y();
  const double iou = boxOverlap(a, b).ground_iou;
  const double intersection = iou / (1 + iou) * (area_a + area_b);
  return intersection / std::min(area_a, area_b);
}

/** Number of scans in which each pair of tracks overlaps. \param boxes ordered by scan */
std::map<TrackPair, std::size_t> countOverlaps(const std::vector<TrackBox>& boxes, double overlap)
{
  std::map<TrackPair, std::size_t> scans;
  for (auto begin = boxes.begin(); begin != boxes.end();)
  {
    const auto end = std::find_if(begin, boxes.end(),
                                  [&](const TrackBox& box) { return box.scan != begin->scan; });
    for (auto a = begin; a != end; ++a)
    {
      for (auto b = std::next(a); b != end; ++b)
      {
        if (sharedFootprint(a->box, b->box) > overlap)
        {
          ++scans[std::minmax(a->track, b->track)];
        }
      }
    }
    begin = end;
  }
  return scans;
}

/** Number of common values. \param a, b ascending */
std::size_t countCommon(const std::vector<std::size_t>& a, const std::vector<std::size_t>& b)
{
  std::vector<std::size_t> common;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
  return common.size();
}

/** Track that `track` is merged into, or `track` itself. */
int rootOf(const std::map<int, int>& merged, int track)
{
  for (auto into = merged.find(track); into != merged.end(); into = merged.find(track))
  {
    track = into->second;
  }
  return track;
}
}  // namespace

std::map<int, int> findMergedTracks(std::vector<TrackBox> boxes, double overlap, double least_share)
{
  if (overlap >= 1)
  {
    return {};  // rounding may give shares above 1
  }
  std::sort(boxes.begin(), boxes.end(),
            [](const TrackBox& a, const TrackBox& b)
            { return std::tie(a.scan, a.track) < std::tie(b.scan, b.track); });
  std::map<int, std::vector<std::size_t>> scans_of_track;
  for (const TrackBox& box : boxes)
  {
    scans_of_track[box.track].push_back(box.scan);
  }
  std::map<int, int> merged;
  for (const auto& [pair, overlapping] : countOverlaps(boxes, overlap))
  {
    const std::size_t common = countCommon(scans_of_track[pair.first], scans_of_track[pair.second]);
    const int a = rootOf(merged, pair.first);
    const int b = rootOf(merged, pair.second);
    if (a != b && static_cast<double>(overlapping) >= least_share * static_cast<double>(common))
    {
      merged[std::max(a, b)] = std::min(a, b);
    }
  }
  for (auto& [track, into] : merged)
  {
    into = rootOf(merged, into);
  }
  return merged;
}
}  // namespace dyslam
