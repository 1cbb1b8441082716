#include "verify/efficiency.h"

#include "verify/in_order.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <nlohmann/json.hpp>

namespace faceta {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double root_above_one(double square) {
  return std::sqrt(std::max(square - 1, 0.0));
}

double degrees_of(const Vec3<float>& w) {
  double sine = std::hypot(double(w.x), double(w.y));
  return std::atan2(sine, double(w.z)) * 180 / kPi;
}

Color<double> weight_of(const SampleBatch& batch, int i) {
  if (!batch.valid(i))
    return {};
  return {batch.weight[0][i], batch.weight[1][i], batch.weight[2][i]};
}

} // namespace

EfficiencyPoint study_efficiency(const Subject& subject, const Vec3<float>& wo, int samples) {
  SampleBatch batch(samples);
  RandomStream random(subject.stream(0xeff));
  batch.set_all_viewers(wo);
  batch.draw(random);
  subject.run(batch, TransportMode::importance);
  EfficiencyPoint point;
  point.wo = wo;
  point.theta = degrees_of(wo);
  int failed = 0;
  for (int i = 0; i < samples; ++i) {
    point.mean += weight_of(batch, i);
    failed += !batch.valid(i);
  }
  point.mean = point.mean * (1.0 / samples);
  point.failed = double(failed) / samples;
  int channels = 0;
  Color<double> scale;
  for (int c = 0; c < 3; ++c)
    if (point.mean[c] > 0) {
      ++channels;
      scale[c] = 1 / point.mean[c];
    }
  point.variation = point.best = point.of_rule = kNone;
  if (channels == 0)
    return point;
  double sum = 0, squares = 0;
  for (int i = 0; i < samples; ++i) {
    Color<double> w = weight_of(batch, i) * scale;
    double square = (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]) / channels;
    squares += square;
    sum += std::sqrt(square);
  }
  double mean = sum / samples;
  point.variation = root_above_one(squares / samples);
  point.best = root_above_one(mean * mean);
  point.of_rule = root_above_one(mean * mean / (1 - point.failed));
  return point;
}

EfficiencyReport study_efficiencies(const std::vector<SuiteSubject>& subjects, int samples,
                                    uint64_t seed) {
  EfficiencyReport report;
  report.samples = samples;
  report.seed = seed;
  for (const SuiteSubject& s : subjects) {
    report.rows.push_back({s, {}});
    report.rows.back().subject.subject.seed = seed;
  }
  run_in_order(report.rows.size(), [&](size_t i) {
    EfficiencyReport::Row& row = report.rows[i];
    for (const Vec3<float>& wo : viewers(row.subject.subject, Effort::quick))
      row.points.push_back(study_efficiency(row.subject.subject, wo, samples));
  });
  return report;
}

// --- Text ---

namespace {

constexpr int kName = 33;
constexpr double kAngles[] = {0, 30, 60, 80, 89};

std::string figure(double value) {
  if (std::isnan(value))
    return "-";
  return value < 9.995 ? fmt::format("{:.3f}", value) : fmt::format("{:.3g}", value);
}

/// The worst azimuth at an angle; null if there is none.
const EfficiencyPoint* worst_at(const EfficiencyReport::Row& row, double theta) {
  const EfficiencyPoint* worst = nullptr;
  for (const EfficiencyPoint& p : row.points)
    if (std::abs(p.theta - theta) < 0.1 && (!worst || !(p.variation <= worst->variation)))
      worst = &p;
  return worst;
}

std::string cells(const EfficiencyReport::Row& row, bool inside) {
  std::string line;
  for (double angle : kAngles) {
    const EfficiencyPoint* p = worst_at(row, inside ? 180 - angle : angle);
    line += p ? fmt::format("{:>7} {:<5}", figure(p->variation), figure(p->best)) : "";
  }
  return line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
}

std::string table(const EfficiencyReport& report) {
  std::string text = fmt::format("{:{}}", "", kName);
  for (double angle : kAngles)
    text += fmt::format("{:>6}°{:6}", angle, "");
  text = text.substr(0, text.find_last_not_of(' ') + 1) + "\n";
  for (const EfficiencyReport::Row& row : report.rows) {
    std::string name = row.subject.name;
    if (name.size() > size_t(kName))
      name = name.substr(0, kName - 3) + "...";
    text += fmt::format("{:{}}", name, kName) + cells(row, false);
    if (row.subject.subject.traits().two_sided)
      text += fmt::format("{:{}}", "  from inside", kName) + cells(row, true);
  }
  return text + "\nFor each angle: coefficient of variation of the weights, and the least that any "
                "rule leaves.\nBlack materials have none.\n";
}

std::string details(const EfficiencyReport::Row& row) {
  std::string text = row.subject.name + "\n";
  text += fmt::format("{:>6} {:>8} {:>10} {:>8} {:>8} {:>8}   {}\n", "theta", "phi", "variation",
                      "best", "of rule", "failed", "mean weight");
  for (const EfficiencyPoint& p : row.points) {
    double phi = p.wo.x == 0 && p.wo.y == 0 ? 0 : std::atan2(p.wo.y, p.wo.x) * 180 / kPi;
    text += fmt::format("{:>6.0f} {:>8.0f} {:>10} {:>8} {:>8} {:>7.2f}%   {:.4f} {:.4f} {:.4f}\n",
                        p.theta, phi, figure(p.variation), figure(p.best), figure(p.of_rule),
                        100 * p.failed, p.mean[0], p.mean[1], p.mean[2]);
  }
  return text + "\nvariation: coefficient of variation of the weights. best: the least that any "
                "rule leaves;\nof rule: the least that a rule leaves whose samples fail as often."
                "\n";
}

nlohmann::ordered_json number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

} // namespace

std::string efficiency_text(const EfficiencyReport& report) {
  return report.rows.size() == 1 ? details(report.rows[0]) : table(report);
}

std::string efficiency_json(const EfficiencyReport& report, const std::string& version) {
  using Json = nlohmann::ordered_json;
  Json json{{"version", version},
            {"samples", report.samples},
            {"seed", report.seed},
            {"isa", kIsaNames[int(best_isa())]},
            {"subjects", Json::array()}};
  for (const EfficiencyReport::Row& row : report.rows) {
    const Subject& subject = row.subject.subject;
    Json parameters = Json::object(), points = Json::array();
    for (const auto& [name, value] : subject.given())
      parameters[name] = value;
    for (const EfficiencyPoint& p : row.points)
      points.push_back({{"wo", {p.wo.x, p.wo.y, p.wo.z}},
                        {"theta", p.theta},
                        {"variation", number(p.variation)},
                        {"best", number(p.best)},
                        {"of_rule", number(p.of_rule)},
                        {"failed", p.failed},
                        {"mean", {p.mean[0], p.mean[1], p.mean[2]}}});
    json["subjects"].push_back({{"name", row.subject.name},
                                {"model", subject.descriptor().name},
                                {"parameters", parameters},
                                {"points", points}});
  }
  return json.dump(2) + "\n";
}

} // namespace faceta
