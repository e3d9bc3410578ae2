// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/BoxOverlap.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/formats/TrackFiles.h>
#include <dyslam/formats/TrackTable.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <sstream>
#include <string>

#include "../results/ReportedObjects.h"
#include "../results/RunHistory.h"
#include "RunOutput.h"
#include "StreamedFile.h"

namespace dyslam
{
namespace
{
/** Box of an object in the lidar frame of a scan. \param object with its box in odometry frame */
LabelledBox labelledBox(const TrackedObject& object,
                        const PastScan& scan,
                        const Pose& T_vehicle_lidar)
{
  LabelledBox box;
  box.frame = static_cast<int>(scan.index);
  box.id = object.id;
  box.object_class = object.object_class;
  box.type = toString(object.object_class);
  box.box = transformed(object.box, (scan.T_odom_vehicle * T_vehicle_lidar).inverse());
  box.score = object.score;
  return box;
}

/** The reported objects: `tracks.csv`, boxes in the odometry frame, and `tracks.txt`, in the lidar
 * frame of each scan. */
class TrackOutput : public RunOutput
{
 public:
  explicit TrackOutput(const RunOutputContext& context)
      : RunOutput(context, {run_files::track_table, run_files::tracks})
  {
  }
  [[nodiscard]] WantedFrames wants() const override { return WantedFrames::final_objects; }
  void open() override { rows_.open(path(run_files::track_table), trackTableHeader()); }
  void add(const Frame& frame) override
  {
    std::string rows;
    for (const TrackedObject& object : frame.objects)
    {
      if (object.reported)
      {
        rows += trackTableRow(object, frame.index, frame.scan.stamp);
      }
    }
    rows_.write(rows);
    next_frame_ = frame.index + 1;
  }
  void checkpoint(const RunResults& results) override { writeBoxes(results); }
  void exchangeState(StateArchive& archive) override
  {
    archive(next_frame_);
    if (archive.isLoading())
    {
      rows_.open(path(run_files::track_table), rowsSoFar());
      rows_.keep();
      std::error_code ignored;
      std::filesystem::remove(path(run_files::track_table), ignored);
    }
  }
  void finish(const RunResults& results) override
  {
    eachByItself({[&] { writeBoxes(results); },
                  [&]
                  {
                    rows_.close();
                    writeWhole(
                        path(run_files::track_table),
                        [&](std::ostream& out)
                        {
                          out << trackTableHeader();
                          forEachReported(
                              results, [&](const ReportedObject& s)
                              { out << trackTableRow(s.object, s.scan.index, s.scan.stamp); });
                        });
                  }});
  }

 private:
  /** Header and rows of the frames so far: of the growing table or, after the end of a stopped run,
   * of the final table, whose rows differ; they are replaced at the end of this run. */
  [[nodiscard]] std::string rowsSoFar() const
  {
    const std::string growing = path(run_files::track_table) + ".tmp";
    const std::string file =
        std::filesystem::exists(growing) ? growing : path(run_files::track_table);
    std::string rows = trackTableHeader();
    std::istringstream lines(std::filesystem::exists(file) ? readWhole(file) : "");
    std::string line;
    std::getline(lines, line);  // the header
    while (std::getline(lines, line) && !lines.eof())
    {
      if (std::strtoull(line.c_str(), nullptr, 10) < next_frame_)
      {
        rows += line + '\n';
      }
    }
    return rows;
  }

  void writeBoxes(const RunResults& results) const
  {
    writeWhole(path(run_files::tracks),
               [&](std::ostream& out)
               {
                 forEachReported(results,
                                 [&](const ReportedObject& s)
                                 {
                                   const Pose& T_vehicle_lidar =
                                       results.history->mounts()[s.scan.mount];
                                   out << trackLine(labelledBox(s.object, s.scan, T_vehicle_lidar));
                                 });
               });
  }

  StreamedFile rows_;
  std::size_t next_frame_ = 0;  //!< number after that of the last frame with rows
};
}  // namespace

std::unique_ptr<RunOutput> makeTrackOutput(const RunOutputContext& context)
{
  return std::make_unique<TrackOutput>(context);
}
}  // namespace dyslam
