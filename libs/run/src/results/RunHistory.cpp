// SPDX-License-Identifier: BSD-3-Clause
#include "RunHistory.h"

#include <dyslam/base/Bytes.h>

#include <algorithm>
#include <utility>

namespace dyslam
{
namespace
{
constexpr std::size_t part_size = 4096;

PastObject pastObject(const TrackedObject& object, std::size_t scan)
{
  PastObject past;
  past.scan = scan;
  past.id = object.id;
  past.object_class = object.object_class;
  past.box = object.box;
  past.velocity = object.velocity;
  past.score = object.score;
  past.dynamic = object.dynamic;
  past.observed = object.observed;
  past.reported = object.reported;
  return past;
}

/** Calls `field` with every number of an object, which has Eigen members and padding. */
template <typename Object, typename Field>
void forEachField(Object& o, const Field& field)
{
  field(o.scan);
  field(o.id);
  field(o.object_class);
  for (int i = 0; i < 3; ++i)
  {
    field(o.box.centre[i]);
    field(o.box.size[i]);
    field(o.velocity[i]);
  }
  field(o.box.yaw);
  field(o.score);
  field(o.dynamic);
  field(o.observed);
  field(o.reported);
}

/** Which of two tracks of the same object counts at a scan. */
bool isPreferred(const PastObject& a, const PastObject& b)
{
  return std::make_pair(!a.observed, a.id) < std::make_pair(!b.observed, b.id);
}
}  // namespace

TrackedObject PastObject::tracked() const
{
  TrackedObject object;
  object.id = id;
  object.object_class = object_class;
  object.box = box;
  object.velocity = velocity;
  object.score = score;
  object.dynamic = dynamic;
  object.observed = observed;
  object.reported = true;
  return object;
}

std::string RunHistory::Part::toBytes() const
{
  std::string bytes;
  for (const PastObject& object : objects)
  {
    forEachField(object, [&bytes](const auto& value) { appendBytes(bytes, value); });
  }
  return bytes;
}

RunHistory::Part RunHistory::Part::fromBytes(std::string_view bytes)
{
  Part part;
  while (!bytes.empty())
  {
    part.objects.emplace_back();
    forEachField(part.objects.back(), [&bytes](auto& value) { takeBytes(bytes, value); });
  }
  return part;
}

void RunHistory::addScan(const Frame& frame)
{
  const auto mount = std::find_if(mounts_.begin(), mounts_.end(),
                                  [&](const Pose& T)
                                  { return T.matrix() == frame.scan.T_vehicle_lidar.matrix(); });
  PastScan scan;
  scan.index = frame.index;
  scan.stamp = frame.scan.stamp;
  scan.time = frame.time();
  scan.T_odom_vehicle = frame.T_odom_vehicle;
  scan.points = static_cast<std::uint32_t>(frame.cloud.size());
  scan.moving_points =
      static_cast<std::uint32_t>(std::count(frame.moving.begin(), frame.moving.end(), true));
  scan.mount = static_cast<std::uint32_t>(mount - mounts_.begin());
  scan.registered = frame.motion.registered();
  scan.keyframe = frame.is_keyframe;
  if (mount == mounts_.end())
  {
    mounts_.push_back(frame.scan.T_vehicle_lidar);
  }
  scans_.push_back(scan);
}

void RunHistory::add(std::size_t scan, const TrackedObject& object)
{
  if (objects_.size() == 0 || in_last_part_ == part_size)
  {
    objects_.add({});
    in_last_part_ = 0;
  }
  objects_.edit(objects_.size() - 1).objects.push_back(pastObject(object, scan));
  ++in_last_part_;
}

void RunHistory::noteObservations(std::size_t scan, const std::vector<TrackedObject>& objects)
{
  std::map<int, Observations> unreported;
  for (const TrackedObject& object : objects)
  {
    const auto known = whole_.find(object.id);
    if (known != whole_.end())
    {
      known->second.last = object.observed ? scan : known->second.last;
      continue;
    }
    const auto before = unreported_.find(object.id);
    Observations observations{scan, scan};
    if (before != unreported_.end())
    {
      observations.first = before->second.first;
      observations.last = object.observed ? scan : before->second.last;
    }
    (object.reported ? whole_ : unreported)[object.id] = observations;
  }
  unreported_ = std::move(unreported);
}

void RunHistory::addObjects(std::size_t scan,
                            const std::vector<TrackedObject>& objects,
                            TrackLife life)
{
  const auto found =
      std::lower_bound(scans_.begin(), scans_.end(), scan,
                       [](const PastScan& s, std::size_t index) { return s.index < index; });
  if (found == scans_.end() || found->index != scan)
  {
    return;
  }
  const auto position = static_cast<std::size_t>(found - scans_.begin());
  if (life == TrackLife::whole)
  {
    noteObservations(position, objects);
  }
  for (const TrackedObject& object : objects)
  {
    if (object.reported || life == TrackLife::whole)
    {
      add(position, object);
    }
  }
}

bool RunHistory::counts(const PastObject& object) const
{
  const auto whole = whole_.find(object.id);
  return whole == whole_.end()
             ? object.reported
             : object.scan >= whole->second.first && object.scan <= whole->second.last;
}

void RunHistory::forEachObject(const std::function<void(const PastObject&)>& use) const
{
  for (std::size_t i = 0; i < objects_.size(); ++i)
  {
    for (const PastObject& object : objects_.get(i).objects)
    {
      if (counts(object))
      {
        use(object);
      }
    }
  }
}

void RunHistory::forEachObject(const std::map<int, int>& merged,
                               const std::function<void(const PastObject&)>& use) const
{
  std::map<int, PastObject> of_scan;  // objects of a scan by id
  const auto use_scan = [&]
  {
    for (auto& [id, object] : of_scan)
    {
      object.id = id;
      use(object);
    }
    of_scan.clear();
  };
  forEachObject(
      [&](const PastObject& object)
      {
        if (!of_scan.empty() && of_scan.begin()->second.scan != object.scan)
        {
          use_scan();
        }
        const auto into = merged.find(object.id);
        const int id = into == merged.end() ? object.id : into->second;
        const auto [other, is_first] = of_scan.emplace(id, object);
        if (!is_first && isPreferred(object, other->second))
        {
          other->second = object;
        }
      });
  use_scan();
}

void RunHistory::exchangeState(StateArchive& archive)
{
  archive(scans_, mounts_, objects_, in_last_part_, whole_, unreported_);
}
}  // namespace dyslam
