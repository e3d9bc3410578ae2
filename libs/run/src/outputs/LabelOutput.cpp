// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Files.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/formats/TextFile.h>
#include <dyslam/mapping/HindsightLabels.h>

#include <map>
#include <vector>

#include "../results/RunHistory.h"
#include "RunOutput.h"
#include "ScanLabels.h"

namespace dyslam
{
namespace
{
constexpr const char* label_extension = ".label";

/** Points of an object in a scan that was written before the object was reported. */
struct UnnamedPoints
{
  std::size_t scan = 0;               //!< Frame::index
  std::size_t scan_size = 0;          //!< number of points of the scan
  std::vector<std::uint32_t> points;  //!< indices in the scan

  void exchangeState(StateArchive& archive) { archive(scan, scan_size, points); }
};

/** `labels/NNNNNN.label`: SemanticKITTI labels of every point of the input scan. Where they are
 * labels with hindsight, an object has its instance from its first detection on: it is written to
 * the files of the scans before it was reported. At the end merged tracks get the instance of their
 * object. */
class LabelOutput : public RunOutput
{
 public:
  explicit LabelOutput(const RunOutputContext& context)
      : RunOutput(context, {{run_files::labels, label_extension}}),
        names_earlier_points_(context.config.get<HindsightOptions>("labels").hindsight)
  {
  }
  [[nodiscard]] OutputThread thread() const override { return OutputThread::writer; }
  [[nodiscard]] WantedFrames wants() const override { return WantedFrames::final_scans; }
  void open() override { makeFolder(path(run_files::labels)); }
  void exchangeState(StateArchive& archive) override
  {
    if (archive.isLoading())
    {
      open();
    }
    archive(unnamed_);
  }
  void add(const Frame& frame) override
  {
    writeLabels(numberedPath(path(run_files::labels), frame.index, label_extension),
                scanLabels(frame));
    if (names_earlier_points_)
    {
      nameEarlierPoints(frame);
    }
  }
  void finish(const RunResults& results) override
  {
    for (const auto& [scan, instances] : mergedInstances(results))
    {
      renameObjects(scan, instances);
    }
  }

 private:
  using UnnamedObjects = std::map<int, std::vector<UnnamedPoints>>;  //!< by id of the track

  /** Writes objects that are reported for the first time to the files of the scans before. */
  void nameEarlierPoints(const Frame& frame)
  {
    UnnamedObjects unnamed;
    for (const TrackedObject& object : frame.objects)
    {
      std::vector<UnnamedPoints> earlier = std::move(unnamed_[object.id]);
      if (object.reported)
      {
        for (const UnnamedPoints& scan : earlier)
        {
          nameObject(scan, labelOf(object));
        }
        continue;
      }
      if (object.detection >= 0)
      {
        earlier.push_back({frame.index, frame.scan.size(), sourcesOf(frame, object)});
      }
      if (earlier.size() > most_scans)
      {
        earlier.erase(earlier.begin());
      }
      unnamed[object.id] = std::move(earlier);
    }
    unnamed_ = std::move(unnamed);
  }

  using Renaming = std::map<std::uint16_t, std::uint16_t>;  //!< instance by former instance

  /** For each scan (Frame::index), the instances of merged tracks and of their objects. */
  static std::map<std::size_t, Renaming> mergedInstances(const RunResults& results)
  {
    std::map<std::size_t, Renaming> scans;
    if (results.merged_tracks.empty())
    {
      return scans;  // avoids reading the history, which may be on disk
    }
    results.history->forEachObject(
        [&](const PastObject& object)
        {
          const auto into = results.merged_tracks.find(object.id);
          if (into != results.merged_tracks.end())
          {
            const PastScan& scan = results.history->scans()[object.scan];
            scans[scan.index][instanceOfTrack(object.id)] = instanceOfTrack(into->second);
          }
        });
    return scans;
  }

  void renameObjects(std::size_t scan, const Renaming& instances) const
  {
    const std::string file = numberedPath(path(run_files::labels), scan, label_extension);
    std::vector<Label> labels = readLabels(file);
    for (Label& label : labels)
    {
      const auto renamed = instances.find(instanceOf(label));
      if (renamed != instances.end())
      {
        label = makeLabel(semanticOf(label), renamed->second);
      }
    }
    writeLabels(file, labels);
  }

  void nameObject(const UnnamedPoints& scan, Label label) const
  {
    const std::string file = numberedPath(path(run_files::labels), scan.scan, label_extension);
    std::vector<Label> labels = readLabels(file, scan.scan_size);
    for (const std::uint32_t i : scan.points)
    {
      labels[i] = isMovingLabel(labels[i]) ? label : labels[i];
    }
    writeLabels(file, labels);
  }

  static constexpr std::size_t most_scans = 100;  //!< scans of an object before it is reported

  bool names_earlier_points_;
  UnnamedObjects unnamed_;
};
}  // namespace

std::unique_ptr<RunOutput> makeLabelOutput(const RunOutputContext& context)
{
  return std::make_unique<LabelOutput>(context);
}
}  // namespace dyslam
