// SPDX-License-Identifier: BSD-3-Clause
#include "RunOutput.h"

namespace dyslam
{
// Each function is defined in the file of its name.
RunOutputFactory makeSettingsOutput, makeTrajectoryOutput, makeGeoreferenceOutput, makeGraphOutput,
    makeScanTableOutput, makeScanPartOutput, makeMotionOutput, makeTrackOutput, makeLabelOutput,
    makeProbabilityOutput, makeStaticScanOutput, makeReplayOutput, makeSimplemapOutput,
    makePcdOutput, makePlyOutput, makeSceneOutput, makePlotOutput, makePageOutput, makeReportOutput;

std::vector<RunOutputKind> runOutputKinds()
{
  // Files of an earlier run are removed from the last row to the first: report.json, which marks a
  // complete folder, first, and effective.ini, which marks a run's folder, last.
  return {
      {makeSettingsOutput},
      {makeTrajectoryOutput},
      {makeGeoreferenceOutput},
      {makeGraphOutput},
      {makeScanTableOutput},
      {makeScanPartOutput},
      {makeMotionOutput},
      {makeTrackOutput},
      {makeLabelOutput, nullptr, nullptr, &SlamRunSettings::labels, true},
      {makeProbabilityOutput, nullptr, nullptr, &SlamRunSettings::probabilities},
      {makeStaticScanOutput, nullptr, nullptr, &SlamRunSettings::static_scans},
      {makeReplayOutput, "replay", "write replay.rawlog, for RawLogViewer"},
      {makeSimplemapOutput, "simplemap", "write keyframes.simplemap, the keyframes for MRPT"},
      {makePcdOutput, "pcd", "write map_static.pcd, the static map"},
      {makePlyOutput, "ply", "write map_static.ply, the static map"},
      {makeSceneOutput, "scene", "write map.3Dscene, for SceneViewer3D"},
      {makePlotOutput, "plot", "write trajectory.png, where there is ground truth"},
      {makePageOutput, "page", "write report.html and map.png, the run in a browser"},
      {makeReportOutput},
  };
}
}  // namespace dyslam
