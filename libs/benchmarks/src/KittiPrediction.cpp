// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/benchmarks/JsonText.h>
#include <dyslam/benchmarks/KittiPrediction.h>
#include <dyslam/eval/PredictionMetrics.h>

#include <array>

namespace dyslam
{
namespace
{
constexpr std::array<int, 7> prediction_windows{5, 10, 15, 20, 30, 40, 50};
constexpr int table5_window = 30;
const std::array<const char*, 6> degree_names{"degree 0", "linear",  "quadratic",
                                              "cubic",    "quartic", "quintic"};

/** The paper's Table 4: rows degree 1 to 5, columns as `prediction_windows`. */
constexpr double paper_table4[5][7] = {{0.24, 0.23, 0.26, 0.28, 0.43, 0.62, 0.84},
                                       {0.41, 0.30, 0.26, 0.21, 0.23, 0.28, 0.32},
                                       {1.30, 0.48, 0.39, 0.33, 0.26, 0.27, 0.28},
                                       {1.34, 0.77, 0.60, 0.49, 0.38, 0.31, 0.33},
                                       {1.37, 1.50, 1.00, 0.74, 0.56, 0.43, 0.40}};
/** The paper's Table 5: rows constant velocity, then degrees 1 to 4; columns six targets and their
 * mean. */
constexpr double paper_table5[5][7] = {{1.33, 1.49, 1.37, 1.42, 0.57, 0.65, 1.14},
                                       {1.21, 0.65, 0.54, 0.28, 0.41, 0.45, 0.59},
                                       {0.71, 0.64, 0.60, 0.21, 0.14, 0.22, 0.42},
                                       {0.64, 0.81, 0.85, 0.33, 0.13, 0.23, 0.50},
                                       {0.81, 1.07, 1.17, 0.49, 0.18, 0.29, 0.67}};

/** RMSE of a predictor; nothing if the target is too short for a prediction. */
std::optional<double> oneStepRmse(OneStepPredictor& predictor,
                                  const KittiTarget& target,
                                  int warm_up)
{
  const Statistics error = predictionError(predictor, target.observations, target.truth,
                                           static_cast<std::size_t>(warm_up));
  return error.count > 0 ? std::optional<double>(error.rmse) : std::nullopt;
}

std::optional<double> fixedRmse(const KittiTarget& target, int degree, int window)
{
  return oneStepRmse(*polynomialPredictor(degree, window), target, window);
}

/** RMSE on the frames at which a window of length `window` is full. */
std::optional<double> adaptiveRmse(const KittiTarget& target, int window)
{
  return oneStepRmse(*adaptivePredictor(), target, window);
}

/** Mean of the values that are present. */
std::optional<double> meanOf(const std::vector<std::optional<double>>& values)
{
  double sum = 0;
  int count = 0;
  for (const std::optional<double>& value : values)
  {
    sum += value.value_or(0);
    count += value ? 1 : 0;
  }
  return count > 0 ? std::optional<double>(sum / count) : std::nullopt;
}

template <typename Rmse>
std::optional<double> meanOver(const std::vector<KittiTarget>& targets, Rmse&& of)
{
  std::vector<std::optional<double>> errors;
  for (const KittiTarget& target : targets)
  {
    errors.push_back(of(target));
  }
  return meanOf(errors);
}

std::vector<std::string> windowColumns()
{
  std::vector<std::string> columns{"RMSE [m] by window"};
  for (const int window : prediction_windows)
  {
    columns.push_back(std::to_string(window));
  }
  return columns;
}

/** Mean over the targets for each degree and window, and the adaptive predictor on the same
 * frames. */
Table gridTable(const std::vector<KittiTarget>& targets,
                const std::string& title,
                bool with_paper,
                nlohmann::ordered_json& json)
{
  Table table(windowColumns(), title);
  for (int degree = 1; degree <= 5; ++degree)
  {
    std::vector<TableCell> row{degree_names[static_cast<std::size_t>(degree)]};
    for (std::size_t w = 0; w < prediction_windows.size(); ++w)
    {
      const std::optional<double> ours =
          meanOver(targets, [&](const KittiTarget& t)
                   { return fixedRmse(t, degree, prediction_windows[w]); });
      const std::optional<double> paper =
          with_paper ? std::optional<double>(paper_table4[degree - 1][w]) : std::nullopt;
      row.emplace_back(ours, 3, paper);
      json["grid"][std::to_string(degree)][std::to_string(prediction_windows[w])] = orNull(ours);
    }
    table.addRow(row);
  }
  std::vector<TableCell> row{"adaptive"};
  for (const int window : prediction_windows)
  {
    const std::optional<double> ours =
        meanOver(targets, [&](const KittiTarget& t) { return adaptiveRmse(t, window); });
    row.emplace_back(ours, 3);
    json["grid"]["adaptive"][std::to_string(window)] = orNull(ours);
  }
  table.addRow(row);
  return table;
}

/** Table 5: window 30, the targets in columns. */
Table targetTable(const std::vector<KittiTarget>& targets,
                  const std::string& title,
                  nlohmann::ordered_json& json)
{
  std::vector<std::string> columns{"RMSE [m], K = 30"};
  for (const KittiTarget& target : targets)
  {
    columns.push_back(target.name);
  }
  columns.emplace_back("mean");
  Table table(columns, title);
  const auto addRow = [&](const std::string& name, const double* paper, auto&& of)
  {
    std::vector<TableCell> row{name};
    std::vector<std::optional<double>> errors;
    for (std::size_t i = 0; i < targets.size(); ++i)
    {
      const std::optional<double> ours = of(targets[i]);
      errors.push_back(ours);
      row.emplace_back(ours, 3, paper ? std::optional<double>(paper[i]) : std::nullopt);
      json["table5"][name][targets[i].name] = orNull(ours);
    }
    const std::optional<double> mean = meanOf(errors);
    row.emplace_back(mean, 3, paper ? std::optional<double>(paper[targets.size()]) : std::nullopt);
    json["table5"][name]["mean"] = orNull(mean);
    table.addRow(row);
  };
  addRow("last position", nullptr,
         [](const KittiTarget& t) { return oneStepRmse(*polynomialPredictor(0, 1), t, 2); });
  addRow("constant velocity", paper_table5[0],
         [](const KittiTarget& t) { return oneStepRmse(*constantVelocityPredictor(), t, 2); });
  for (int degree = 1; degree <= 5; ++degree)
  {
    addRow(degree_names[static_cast<std::size_t>(degree)],
           degree <= 4 ? paper_table5[degree] : nullptr,
           [&](const KittiTarget& t) { return fixedRmse(t, degree, table5_window); });
  }
  addRow("adaptive", nullptr, [](const KittiTarget& t) { return adaptiveRmse(t, table5_window); });
  return table;
}
}  // namespace

PaperPrediction predictPaperTargets(const std::string& data, bool from_detections)
{
  const std::string from = from_detections ? "PointRCNN detections" : "labels";
  const std::vector<KittiTarget> targets = readPaperTargets(data, from_detections);
  const std::vector<KittiTarget> target10{targets[3]};
  nlohmann::ordered_json one;
  nlohmann::ordered_json all;
  const Table table4 = gridTable(target10, "Table 4, target 10/0, from " + from, true, one);
  const Table table5 = targetTable(targets, "Table 5, from " + from, all);
  const Table means =
      gridTable(targets, "Mean of the six targets, from " + from + "; adaptive on the same frames",
                false, all);
  return {from, table4, table5, means, {{"10/0", one}, {"six targets", all}}};
}

TargetPrediction predictTarget(const KittiTarget& target)
{
  nlohmann::ordered_json json;
  const Table table = gridTable({target}, "", false, json);
  const std::optional<double> constant = oneStepRmse(*constantVelocityPredictor(), target, 2);
  json["constant velocity"] = orNull(constant);
  return {table, constant, textOf(json)};
}
}  // namespace dyslam
