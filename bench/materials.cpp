/// Nanoseconds per eval and per sample of every registered model in every instruction set.

#include "bsdf/columns.h"
#include "bsdf/registry.h"
#include "formats/measured_loader.h"
#include "results.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fmt/core.h>
#include <numbers>
#include <random>

namespace faceta::bench {

namespace {

constexpr int kElements = 4096; ///< a few arrays of them lie in the second-level cache

struct Options {
  std::string json, only;
  std::vector<std::string> files; ///< of measured reflectance
  int exemplars = 3;
  double budget = 0.03; ///< seconds a number
};

enum Call { kEval, kSample, kBoth, kCalls };
constexpr const char* kCallNames[] = {"eval", "sample", "eval_sample"};

/// Uniform directions in the upper hemisphere and uniform random numbers.
struct Queries {
  EvalColumns eval{kElements};
  SampleColumns sample{kElements};

  Queries() {
    std::mt19937 generator(1);
    std::uniform_real_distribution<float> uniform(0.0f, std::nextafter(1.0f, 0.0f));
    auto direction = [&](std::array<std::vector<float>, 3>& w, size_t i) {
      float z = std::max(1e-3f, uniform(generator)), r = std::sqrt(1 - z * z);
      float phi = 2 * std::numbers::pi_v<float> * uniform(generator);
      w[0][i] = r * std::cos(phi);
      w[1][i] = r * std::sin(phi);
      w[2][i] = z;
    };
    for (size_t i = 0; i < eval.pdf.size(); ++i) {
      direction(eval.wo, i);
      direction(eval.wi, i);
      for (int k = 0; k < 3; ++k)
        sample.wo[k][i] = eval.wo[k][i];
      sample.u[0][i] = uniform(generator);
      sample.u[1][i] = uniform(generator);
      sample.uc[i] = uniform(generator);
    }
  }
};

/// Median nanoseconds per element over batches of about a millisecond.
double measure(const MaterialKernel& kernel, const MaterialArgs& args, Call call, Queries& queries,
               double budget) {
  EvalArrays e = queries.eval.arrays();
  SampleArrays s = queries.sample.arrays();
  auto run = [&](int repetitions) {
    double start = wall_seconds();
    for (int i = 0; i < repetitions; ++i)
      if (call == kEval)
        kernel.eval(args, e, kElements);
      else if (call == kSample)
        kernel.sample(args, s, kElements);
      else
        kernel.eval_sample(args, e, s, kElements);
    return wall_seconds() - start;
  };
  run(1);
  double once = run(1);
  int repetitions = std::max(1, static_cast<int>(1e-3 / once));
  int batches = std::clamp(static_cast<int>(budget / (once * repetitions)), 5, 101);
  std::vector<double> times;
  for (int i = 0; i < batches; ++i)
    times.push_back(run(repetitions) / (double(repetitions) * kElements) * 1e9);
  return median(times);
}

/// What the project wants to reach, and the exemplar it is measured on.
double goal(const std::string& name, Isa isa, Call call) {
  if (isa != Isa::v4 || call == kBoth)
    return 0;
  if (name.rfind("measured: ", 0) == 0)
    return call == kEval ? 40 : 80;
  if (name != "roughconductor: gold of the course")
    return 0;
  return call == kEval ? 4 : 5;
}

std::vector<Isa> supported_isas() {
  std::vector<Isa> isas;
  for (int i = 0; i < kIsaCount; ++i)
    if (isa_supported(static_cast<Isa>(i)))
      isas.push_back(static_cast<Isa>(i));
  return isas;
}

void print_header(const std::vector<Isa>& isas) {
  std::string line = fmt::format("{:<44}", "ns per element");
  for (int call = 0; call < kCalls; ++call)
    for (Isa isa : isas)
      line += fmt::format("{:>8}", kIsaNames[static_cast<int>(isa)]);
  std::string calls(44, ' ');
  for (const char* name : kCallNames)
    calls += fmt::format("{:>{}}", name, 8 * isas.size());
  fmt::print("{}\n{}\n", calls, line);
}

/// One row of the table. Returns the lines about goals.
std::string bench_exemplar(const Model& model, const Exemplar& exemplar,
                           const std::vector<Isa>& isas, Queries& queries, const Options& options,
                           Results& results) {
  Parameters parameters(model);
  for (const auto& [key, value] : exemplar.settings)
    parameters.set(key, value);
  Record record = parameters.record();
  MaterialArgs args = record.args();
  std::string name = model.name() + ": " + exemplar.name, goals;
  fmt::print("{:<44}", name);
  for (int c = 0; c < kCalls; ++c) {
    Call call = static_cast<Call>(c);
    double scalar = 0;
    for (Isa isa : isas) {
      int i = static_cast<int>(isa);
      double ns = measure(*model.kernels[i], args, call, queries, options.budget);
      std::string title = name + ", " + kCallNames[call];
      double wanted = goal(name, isa, call);
      results.add(title, kIsaNames[i], "ns", ns,
                  wanted > 0 ? fmt::format("goal: at most {} ns", wanted) : "");
      if (wanted > 0)
        goals += fmt::format("goal: {} in {}: {:.2f} ns, wanted at most {}: {}\n", title,
                             kIsaNames[i], ns, wanted, ns <= wanted ? "reached" : "MISSED");
      if (isa == Isa::scalar)
        scalar = ns;
      else
        results.add(title + ", speed-up", kIsaNames[i], "x", scalar / ns, "the scalar kernel");
      fmt::print("{:8.2f}", ns);
      std::fflush(stdout);
    }
  }
  fmt::print("\n");
  return goals;
}

int run(const Options& options) {
  FlushDenormals flush;
  std::vector<Isa> isas = supported_isas();
  Queries queries;
  Results results;
  std::string goals;
  print_header(isas);
  const Model& measured = Registry::global().get("measured");
  for (const std::string& file : options.files) {
    Exemplar exemplar{std::filesystem::path(file).filename().string(), {{"filename", file}}};
    goals += bench_exemplar(measured, exemplar, isas, queries, options, results);
  }
  for (const auto& model : Registry::global().models()) {
    if (!options.files.empty() || (!options.only.empty() && model->name() != options.only))
      continue;
    const std::vector<Exemplar>& exemplars = model->descriptor.exemplars;
    size_t count = std::min(exemplars.size(), static_cast<size_t>(options.exemplars));
    for (size_t i = 0; i < count; ++i)
      goals += bench_exemplar(*model, exemplars[i], isas, queries, options, results);
  }
  fmt::print("{}{} elements a call, directions over the upper hemisphere, medians\n", goals,
             kElements);
  results.write(options.json);
  return 0;
}

} // namespace

} // namespace faceta::bench

int main(int argc, char** argv) {
  try {
    faceta::bench::Options options;
    CLI::App app("Nanoseconds per eval and sample of every model and instruction set.");
    app.add_option("--json", options.json, "write the numbers to this file");
    app.add_option("--only", options.only, "this model alone");
    app.add_option("--file", options.files, "these measured files alone");
    app.add_option("--exemplars", options.exemplars, "parameter sets of a model (the first ones)")
        ->capture_default_str();
    app.add_option("--budget", options.budget, "seconds a number")->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    faceta::load_measured_files();
    return faceta::bench::run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_materials: %s\n", error.what());
    return 3;
  }
}
