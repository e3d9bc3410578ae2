// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
#include <dyslam/benchmarks/DetectionDeskew.h>
#include <dyslam/benchmarks/JsonText.h>
#include <dyslam/benchmarks/KittiMot.h>
#include <dyslam/core/BoxOverlap.h>
#include <dyslam/core/TimeRange.h>
#include <dyslam/formats/KittiTracks.h>
#include <dyslam/formats/TrajectoryFiles.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <type_traits>
#include <utility>

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
/** Projection of a box in the lidar frame, clipped to the image [px]. */
Eigen::Vector4d inImage(const Box& box, const KittiCalib& calib)
{
  constexpr double image_width = 1242;
  constexpr double image_height = 375;
  constexpr double nearest = 0.1;  // least distance of a projected corner [m]
  Eigen::Vector4d image(image_width, image_height, 0, 0);
  for (int corner = 0; corner < 8; ++corner)
  {
    const Eigen::Vector3d half(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5,
                               corner & 4 ? 0.5 : -0.5);
    Eigen::Vector3d p =
        calib.T_cam_velo * (box.centre + Eigen::AngleAxisd(box.yaw, Eigen::Vector3d::UnitZ()) *
                                             half.cwiseProduct(box.size));
    p.z() = std::max(p.z(), nearest);
    const Eigen::Vector3d pixel = calib.P2 * p.homogeneous();
    const double x = std::clamp(pixel.x() / pixel.z(), 0.0, image_width);
    const double y = std::clamp(pixel.y() / pixel.z(), 0.0, image_height);
    image << std::min(image[0], x), std::min(image[1], y), std::max(image[2], x),
        std::max(image[3], y);
  }
  return image;
}

/** Input of the tracker for one sequence. */
struct Recording
{
  KittiCalib calib;
  std::vector<double> stamps;  // [s]
  std::vector<Pose> poses;     // T_world_velo
  std::vector<std::vector<Detection>> detections;
  std::vector<std::vector<Eigen::Vector4d>> image_boxes;  // image boxes of the detections [px]
};

std::vector<double> frameTimes(const KittiMotSetup& setup, const std::string& name, std::size_t n)
{
  const std::string path = setup.data + "/times/" + name + ".txt";
  if (!fs::exists(path))
  {
    std::vector<double> stamps;
    for (std::size_t f = 0; f < n; ++f)
    {
      stamps.push_back(static_cast<double>(f) * setup.frame_time);
    }
    return stamps;
  }
  std::vector<double> stamps = readTimes(path);
  if (stamps.size() < n)
  {
    throw UserError(path + ": has " + counted(stamps.size(), "time") + "; oxts has " +
                    counted(n, "frame"));
  }
  return stamps;
}

std::vector<LabelledBox> detectionsOf(const KittiMotSetup& setup,
                                      const std::string& name,
                                      const std::string& type,
                                      const KittiCalib& calib)
{
  const fs::path folder(setup.detections);
  const fs::path own = folder / type / (name + ".txt");
  const fs::path common = folder / (name + ".txt");
  if (!fs::exists(own) && !fs::exists(common))
  {
    throw UserError(setup.detections + ": has neither " + name + ".txt nor " + type + "/" + name +
                    ".txt, the detections of sequence " + name);
  }
  std::vector<LabelledBox> boxes =
      readDetections((fs::exists(own) ? own : common).string(), calib.T_cam_velo);
  boxes.erase(
      std::remove_if(boxes.begin(), boxes.end(),
                     [&](const LabelledBox& box) { return toString(box.object_class) != type; }),
      boxes.end());
  return boxes;
}

Recording readRecording(const KittiMotSetup& setup,
                        const std::string& name,
                        const std::string& type)
{
  Recording recording;
  recording.calib = readKittiCalib(setup.data + "/calib/" + name + ".txt");
  recording.poses = kittiLidarPoses(setup.data + "/oxts/" + name + ".txt", recording.calib);
  const std::size_t frames = recording.poses.size();
  recording.stamps = frameTimes(setup, name, frames);
  recording.detections.resize(frames);
  recording.image_boxes.resize(frames);
  std::mt19937 generator(static_cast<unsigned>(setup.seed));
  std::normal_distribution<double> normal;
  for (LabelledBox& box : detectionsOf(setup, name, type, recording.calib))
  {
    const Eigen::Vector2d draw(normal(generator), normal(generator));
    if (box.frame < 0 || static_cast<std::size_t>(box.frame) >= frames)
    {
      continue;
    }
    box.box.centre.head<2>() += setup.added_noise * draw;
    Detection detection;
    detection.box = box.box;
    detection.object_class = box.object_class;
    detection.score = box.score;
    detection.covariance = detectionCovariance(box.box, box.object_class, setup.noise);
    recording.detections[static_cast<std::size_t>(box.frame)].push_back(detection);
    recording.image_boxes[static_cast<std::size_t>(box.frame)].push_back(box.image_box);
  }
  return recording;
}

/** Adds number and highest score of the detections. */
void count(const Recording& recording, KittiMotRun& run)
{
  for (const std::vector<Detection>& of_frame : recording.detections)
  {
    for (const Detection& detection : of_frame)
    {
      run.highest_score =
          run.detections == 0 ? detection.score : std::max(run.highest_score, detection.score);
      ++run.detections;
    }
  }
}

/** Keeps the frames 0, n, 2 n, ... and numbers them anew. */
void keepEvery(int n, Recording& recording, std::vector<LabelledBox>& labels)
{
  const auto step = static_cast<std::size_t>(n);
  const auto thin = [step](auto& frames)
  {
    std::decay_t<decltype(frames)> kept;
    for (std::size_t f = 0; f < frames.size(); f += step)
    {
      kept.push_back(frames[f]);
    }
    frames = std::move(kept);
  };
  thin(recording.stamps);
  thin(recording.poses);
  thin(recording.detections);
  thin(recording.image_boxes);
  labels.erase(std::remove_if(labels.begin(), labels.end(),
                              [n](const LabelledBox& box) { return box.frame % n != 0; }),
               labels.end());
  for (LabelledBox& box : labels)
  {
    box.frame /= n;
  }
}

/** Reported tracks of a frame in the lidar frame. Predicted tracks that left the image are not
 * reported because there are no labels outside the image. */
void collect(const std::vector<TrackedObject>& objects,
             const Recording& recording,
             std::size_t frame,
             const Pose& motion,
             double interval,
             std::vector<LabelledBox>& estimate)
{
  const Pose T_velo_world = recording.poses[frame].inverse();
  for (const TrackedObject& object : objects)
  {
    if (!object.reported)
    {
      continue;
    }
    LabelledBox box;
    box.frame = static_cast<int>(frame);
    box.id = object.id;
    box.object_class = object.object_class;
    box.type = toString(object.object_class);
    box.box = transformed(object.box, T_velo_world);
    if (interval > 0)
    {
      box.box = skewed(box.box, motion, interval, kitti_scan_period);
    }
    box.score = object.score;
    box.image_box = object.detection >= 0
                        ? recording.image_boxes[frame][static_cast<std::size_t>(object.detection)]
                        : inImage(box.box, recording.calib);
    const bool in_view = box.box.centre.x() > 0.5 && box.image_box[2] - box.image_box[0] > 2;
    if (object.detection >= 0 || in_view)
    {
      estimate.push_back(box);
    }
  }
}

void trackSequence(Recording& recording,
                   const KittiMotSetup& setup,
                   TrackSequence& sequence,
                   double& seconds)
{
  Tracker tracker(setup.tracker);
  for (std::size_t f = 0; f < recording.poses.size(); ++f)
  {
    Pose motion = Pose::Identity();
    double interval = 0;
    if (setup.deskew && f > 0)
    {
      // Constant velocity since the previous frame.
      motion = recording.poses[f - 1].inverse() * recording.poses[f];
      interval = recording.stamps[f] - recording.stamps[f - 1];
      deskewDetections(recording.detections[f], motion, interval, kitti_scan_period);
    }
    const auto start = std::chrono::steady_clock::now();
    const std::vector<TrackedObject> objects =
        tracker.update(recording.stamps[f], recording.detections[f], recording.poses[f]);
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    collect(objects, recording, f, motion, interval, sequence.estimate);
  }
}

/** Figures of AB3DMOT (PointRCNN, validation sequences, IoU 0.25), in percent. */
struct Published
{
  const char* type;
  double samota;
  double mota;
  double motp;
  double frames_per_second;
  // Scored by this program: AB3DMOT's script loses tracks whose score equals a threshold to
  // rounding.
  double rescored_samota;
  double rescored_mota;
};
constexpr Published ab3dmot[] = {{"Car", 93.34, 86.47, 79.40, 108.7, 93.55, 87.04},
                                 {"Pedestrian", 82.73, 73.86, 67.58, 119.2, 83.24, 73.86},
                                 {"Cyclist", 93.78, 84.79, 77.23, 980.7, 95.59, 84.79}};

void addMotRows(const std::string& type,
                const KittiMotScores& scores,
                bool with_published,
                Table& table)
{
  const RecallAverages& averages = scores.averages;
  const ClearMot& best = averages.best;
  const auto percent = [](double x) { return TableCell(100 * x, 2); };
  const auto whole = [](std::size_t n) { return TableCell(static_cast<double>(n), 0); };
  table.addRow({type, "ours", percent(averages.samota), percent(averages.amota),
                percent(averages.amotp), percent(best.mota), percent(best.motp),
                whole(best.id_switches), whole(best.fragmentations), whole(best.false_alarms),
                whole(best.misses), percent(scores.higher_order.hota),
                percent(scores.higher_order.association), TableCell(scores.frames_per_second, 0)});
  const auto* p = std::find_if(std::begin(ab3dmot), std::end(ab3dmot),
                               [&](const Published& figures) { return type == figures.type; });
  if (with_published && p != std::end(ab3dmot))
  {
    table.addRow({type, "AB3DMOT, published", TableCell(p->samota, 2), "-", "-",
                  TableCell(p->mota, 2), TableCell(p->motp, 2), "-", "-", "-", "-", "-", "-",
                  TableCell(p->frames_per_second, 1)});
    table.addRow({type, "AB3DMOT, scored alike", TableCell(p->rescored_samota, 2), "-", "-",
                  TableCell(p->rescored_mota, 2), "-", "-", "-", "-", "-", "-", "-", "-"});
  }
}

nlohmann::ordered_json toJson(const KittiMotScores& scores)
{
  const RecallAverages& averages = scores.averages;
  const ClearMot& best = averages.best;
  return {{"samota", averages.samota},
          {"amota", averages.amota},
          {"amotp", averages.amotp},
          {"mota", best.mota},
          {"motp", best.motp},
          {"id_switches", best.id_switches},
          {"fragmentations", best.fragmentations},
          {"false_alarms", best.false_alarms},
          {"misses", best.misses},
          {"references", best.references},
          {"hota", scores.higher_order.hota},
          {"deta", scores.higher_order.detection},
          {"assa", scores.higher_order.association},
          {"frames", scores.frames},
          {"frames_per_second", scores.frames_per_second}};
}
}  // namespace

KittiMotRun runKittiMot(const KittiMotSetup& setup,
                        const std::vector<std::string>& names,
                        const std::string& type)
{
  KittiMotRun run;
  run.every = setup.every;
  for (const std::string& name : names)
  {
    Recording recording = readRecording(setup, name, type);
    TrackSequence sequence;
    sequence.reference = readKittiTracking(setup.data + "/label_02/" + name + ".txt",
                                           recording.calib.T_cam_velo, true);
    keepEvery(setup.every, recording, sequence.reference);
    sequence.frames = static_cast<int>(recording.poses.size());
    count(recording, run);
    trackSequence(recording, setup, sequence, run.seconds);
    run.frames += sequence.frames;
    run.sequences.push_back(std::move(sequence));
  }
  return run;
}

KittiMotRun fastestKittiMot(const KittiMotSetup& setup,
                            const std::vector<std::string>& names,
                            const std::string& type,
                            int repeats)
{
  KittiMotRun run;
  double seconds = std::numeric_limits<double>::infinity();
  for (int i = 0; i < repeats; ++i)
  {
    run = runKittiMot(setup, names, type);
    seconds = std::min(seconds, run.seconds);
  }
  run.seconds = seconds;
  return run;
}

std::string kittiMotWarning(const KittiMotSetup& setup,
                            const KittiMotRun& run,
                            const std::string& type)
{
  if (run.detections == 0)
  {
    return setup.detections + ": has no detections of the class " + type + " in these sequences";
  }
  const bool is_car = type == toString(ObjectClass::car);
  const bool is_pedestrian = type == toString(ObjectClass::pedestrian);
  const ClassTracking& options = is_car          ? setup.tracker.vehicle
                                 : is_pedestrian ? setup.tracker.pedestrian
                                                 : setup.tracker.cyclist;
  if (run.highest_score >= options.birth_score)
  {
    return "";
  }
  const std::string name = is_car ? "vehicle" : is_pedestrian ? "pedestrian" : "cyclist";
  return setup.detections + ": no score of a " + type + " reaches tracker." + name +
         "_birth_score = " + shortNumber(options.birth_score) + " (the highest is " +
         shortNumber(run.highest_score) +
         "), so there are no tracks; kitti_mot.ini is for PointRCNN's scores, which are logits: "
         "--set tracker." +
         name + "_birth_score and " + name + "_match_score";
}

KittiMotScores kittiMotScores(const KittiMotRun& run, const TrackRules& rules)
{
  KittiMotScores scores;
  scores.averages = averagesOverRecall(run.sequences, rules);
  scores.higher_order = hota(tracksAbove(run.sequences, scores.averages.best.threshold), rules);
  scores.frames = run.frames;
  scores.frames_per_second = run.frames / run.seconds;
  return scores;
}

Table kittiMotTable(const NamedKittiMotScores& classes,
                    const std::string& sequences,
                    bool with_published)
{
  Table table({"class", "tracker", "sAMOTA", "AMOTA", "AMOTP", "MOTA", "MOTP", "IDS", "FRAG", "FP",
               "FN", "HOTA", "AssA", "frames/s"},
              "3D tracking of given detections, KITTI " + sequences + " sequences");
  for (const auto& [type, scores] : classes)
  {
    addMotRows(type, scores, with_published, table);
  }
  return table;
}

std::string kittiMotJson(const NamedKittiMotScores& classes)
{
  nlohmann::ordered_json json;
  for (const auto& [type, scores] : classes)
  {
    json[type] = toJson(scores);
  }
  return textOf(json);
}

void writeKittiMot(const std::string& folder,
                   const std::string& data,
                   const std::vector<std::string>& names,
                   const std::vector<KittiMotRun>& runs)
{
  makeFolder(folder);
  for (std::size_t i = 0; i < names.size(); ++i)
  {
    std::vector<LabelledBox> boxes;
    int first_id = 0;
    for (const KittiMotRun& run : runs)
    {
      int next_id = first_id;
      for (LabelledBox box : run.sequences[i].estimate)
      {
        box.frame *= run.every;
        box.id += first_id;
        next_id = std::max(next_id, box.id + 1);
        boxes.push_back(std::move(box));
      }
      first_id = next_id;
    }
    std::stable_sort(boxes.begin(), boxes.end(),
                     [](const LabelledBox& a, const LabelledBox& b) { return a.frame < b.frame; });
    const KittiCalib calib = readKittiCalib(data + "/calib/" + names[i] + ".txt");
    writeKittiTracks((fs::path(folder) / (names[i] + ".txt")).string(), boxes, calib.T_cam_velo);
  }
}

std::vector<std::string> kittiMotValidation()
{
  return {"0001", "0006", "0008", "0010", "0012", "0013", "0014", "0015", "0016", "0018", "0019"};
}

std::vector<std::string> kittiMotTraining()
{
  return {"0000", "0002", "0003", "0004", "0005", "0007", "0009", "0011", "0017", "0020"};
}
}  // namespace dyslam
