/// How near a render comes to the time that Embree alone takes for its rays.

#include "formats/mitsuba_scene.h"
#include "render/render.h"
#include "replay.h"
#include "results.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <bit>
#include <cstdio>
#include <filesystem>
#include <fmt/core.h>
#include <limits>
#include <map>
#include <thread>

namespace faceta::bench {

namespace {

constexpr double kGoal = 1.4;
constexpr double kRecordBytes = 400e6; ///< doubled while a vector grows, doubled by packing

struct Options {
  std::string json, shared, scenes, sampler;
  std::vector<std::string> only, isas;
  int rounds = 9, spp = 0;
  double seconds = 1.5; ///< about what one render of a round should take
};

struct Case {
  std::string name;
  std::filesystem::path file;
  int size = 0; ///< width and height of the film, if not the scene's own
};

std::vector<Case> cases(const Options& options) {
  std::filesystem::path shared(options.shared), own(options.scenes);
  return {{"cornell-box", shared / "rgl-cornell-box/scene_ref320.xml"},
          {"veach-ajar", shared / "rgl-veach-ajar/scene_ref320.xml"},
          {"living-room", shared / "bitterli06-living-room/scene_ref320.xml"},
          {"gallery", own / "material-ball/material-ball.xml", 320}};
}

uint64_t all_rays(const RenderCounters& c) {
  return c.camera_rays + c.closest_rays + c.shadow_rays;
}

struct Timed {
  double wall = 0, cpu = 0;
};

template <class F> Timed timed(const F& f) {
  double wall = wall_seconds(), cpu = cpu_seconds();
  f();
  return {wall_seconds() - wall, cpu_seconds() - cpu};
}

/// The width that Embree traces each kind in fastest; camera rays come in packets of 16.
void pack_fastest(Replay& replay) {
  constexpr int kWidths[] = {1, 8, 16};
  std::array<int, kRayKinds> best{16, 1, 1};
  std::array<double, kRayKinds> least;
  least.fill(std::numeric_limits<double>::infinity());
  std::array<uint64_t, kRayKinds> expected{};
  for (int width : kWidths) {
    replay.pack({16, width, width});
    std::array<uint64_t, kRayKinds> hits = replay.hits(); // also warms the caches up
    if (width == 1)
      expected = hits;
    else if (hits != expected)
      fmt::print("  note: packets of {} hit otherwise than single rays: closest {} and {}, shadow "
                 "{} and {}\n",
                 width, hits[1], expected[1], hits[2], expected[2]);
    for (int repeat = 0; repeat < 3; ++repeat) { // the least: what else the machine does only adds
      std::array<double, kRayKinds> seconds = replay.run_by_kind();
      for (int k = 1; k < kRayKinds; ++k)
        if (seconds[k] < least[k]) {
          least[k] = seconds[k];
          best[k] = width;
        }
    }
  }
  replay.pack(best);
}

/// Everything measured of a scene in one instruction set.
struct Numbers {
  int spp = 0;
  double samples = 0, rays = 0, lane_use = 0;
  double render = 0, embree = 0; ///< median processor seconds of one thread
  double ratio = 0;              ///< median of the rounds'
  double efficiency = 0;         ///< median of the rounds': one thread's wall time over twice two's
  std::array<int, kRayKinds> widths{};
  std::array<double, kRayKinds> ns{}; ///< Embree, per ray and kind
  double busy = 0;                    ///< wall over processor seconds of the one-thread renders
  double two_busy = 0; ///< the same for two threads: twice the wall over processor seconds
};

int choose_spp(const Options& options, const RenderResult& once) {
  if (options.spp > 0)
    return options.spp;
  double by_time = options.seconds / std::max(1e-6, once.seconds);
  double by_memory = kRecordBytes / (32.0 * double(all_rays(once.counters)));
  double spp = std::clamp(std::min(by_time, by_memory), 1.0, 1024.0);
  return static_cast<int>(std::bit_floor(static_cast<unsigned>(spp)));
}

Numbers measure(const Scene& scene, RenderOptions render_options, const Options& options) {
  render_options.threads = 1;
  render_options.spp = 1;
  Numbers n;
  n.spp = render_options.spp = choose_spp(options, render(scene, render_options));

  std::vector<RayRecord> records;
  RenderOptions recording = render_options;
  recording.record = &records;
  RenderResult result = render(scene, recording);
  Replay replay(scene.view(), records);
  pack_fastest(replay);
  n.widths = replay.widths();
  std::array<uint64_t, kRayKinds> rays = replay.rays();
  n.rays = double(rays[0] + rays[1] + rays[2]);
  n.samples = double(result.counters.paths) / render_options.settings.splits;
  int width = Registry::global().render_kernels(render_options.isa)->lane_width;
  n.lane_use = double(result.counters.vertices) / (double(result.counters.groups) * width);

  std::vector<double> renders, embrees, ratios, efficiencies, busy, two_busy;
  for (int round = 0; round < options.rounds; ++round) {
    Timed one = timed([&] { render(scene, render_options); });
    Timed embree = timed([&] { replay.run(); });
    renders.push_back(one.cpu);
    embrees.push_back(embree.cpu);
    ratios.push_back(one.cpu / embree.cpu);
    busy.push_back(one.wall / one.cpu);
    if (std::thread::hardware_concurrency() > 1) {
      RenderOptions both = render_options;
      both.threads = 2;
      Timed two = timed([&] { render(scene, both); });
      efficiencies.push_back(one.wall / (2 * two.wall));
      two_busy.push_back(2 * two.wall / two.cpu);
    }
  }
  std::array<double, kRayKinds> by_kind = replay.run_by_kind();
  for (int k = 0; k < kRayKinds; ++k)
    n.ns[k] = rays[k] ? by_kind[k] / double(rays[k]) * 1e9 : 0;
  n.render = median(renders);
  n.embree = median(embrees);
  n.ratio = median(ratios);
  n.efficiency = efficiencies.empty() ? 0 : median(efficiencies);
  n.busy = median(busy);
  n.two_busy = two_busy.empty() ? 0 : median(two_busy);
  return n;
}

void print_header() {
  fmt::print("{:<13}{:>7}{:>5}{:>12}{:>9}{:>10}{:>10}{:>8}{:>10}{:>11}   {}\n", "scene", "isa",
             "spp", "Msamples/s", "Mrays/s", "render s", "embree s", "ratio", "lane use",
             "2 threads", "embree ns: camera, closest, shadow (packets)");
}

void report(const Case& c, const char* isa, const Numbers& n, Results& results) {
  fmt::print("{:<13}{:>7}{:>5}{:>12.3f}{:>9.2f}{:>10.3f}{:>10.3f}{:>8.3f}{:>10.3f}{:>11}   "
             "{:.1f} (x{}), {:.1f} (x{}), {:.1f} (x{})\n",
             c.name, isa, n.spp, 1e-6 * n.samples / n.render, 1e-6 * n.rays / n.render, n.render,
             n.embree, n.ratio, n.lane_use,
             n.efficiency > 0 ? fmt::format("{:.1f} %", 100 * n.efficiency) : "-", n.ns[0],
             n.widths[0], n.ns[1], n.widths[1], n.ns[2], n.widths[2]);
  if (n.busy > 1.05 || n.two_busy > 1.1)
    fmt::print("  note: wall time was {:.2f} times the processor time with one thread, {:.2f} with "
               "two: on a busy machine the ratio still holds, the last column does not\n",
               n.busy, n.two_busy);
  std::fflush(stdout);
  results.add(c.name + ": floor ratio", isa, "x", n.ratio,
              fmt::format("embree alone, the same rays (goal: at most {})", kGoal));
  results.add(c.name + ": samples", isa, "M/s", 1e-6 * n.samples / n.render);
  results.add(c.name + ": rays", isa, "M/s", 1e-6 * n.rays / n.render);
  results.add(c.name + ": rays of embree alone", isa, "M/s", 1e-6 * n.rays / n.embree);
  results.add(c.name + ": lane use", isa, "1", n.lane_use, "full groups of lanes");
  if (n.efficiency > 0)
    results.add(c.name + ": two-thread efficiency", isa, "1", n.efficiency,
                "one thread (goal: at least 0.95)");
}

std::vector<Isa> chosen_isas(const Options& options) {
  std::vector<Isa> isas;
  for (const std::string& name : options.isas)
    isas.push_back(parse_isa(name));
  if (isas.empty())
    isas.push_back(best_isa());
  return isas;
}

void bench_case(const Case& c, const Options& options, Results& results) {
  if (!std::filesystem::exists(c.file)) {
    fmt::print("{:<13}skipped: there is no {}\n", c.name, c.file.string());
    return;
  }
  for (Isa isa : chosen_isas(options)) {
    std::unique_ptr<Scene> scene = read_mitsuba_scene(c.file);
    scene->build(isa);
    SensorDesc sensor = scene->sensors.at(0);
    if (c.size)
      sensor.film.width = sensor.film.height = c.size;
    if (!options.sampler.empty())
      sensor.sampler.type = options.sampler;
    scene->use_sensor(sensor.camera, sensor.film);
    RenderOptions render_options;
    render_options.settings = render_settings(scene->integrator, sensor.sampler);
    render_options.isa = isa;
    report(c, kIsaNames[static_cast<int>(isa)], measure(*scene, render_options, options), results);
  }
}

int run(const Options& options) {
  Results results;
  print_header();
  bool found = false;
  for (const Case& c : cases(options))
    if (options.only.empty() || std::count(options.only.begin(), options.only.end(), c.name)) {
      found = true;
      bench_case(c, options, results);
    }
  if (!found)
    throw Error("no scene of that name", {}, "cornell-box, veach-ajar, living-room, gallery");
  fmt::print("ratio: processor time of a render over Embree's alone for the same rays, one thread, "
             "median of {} alternating rounds\n",
             options.rounds);
  results.write(options.json);
  return 0;
}

} // namespace

} // namespace faceta::bench

int main(int argc, char** argv) {
  try {
    faceta::bench::Options options;
    CLI::App app("Render time over the time that Embree alone takes for the same rays.");
    app.add_option("--shared", options.shared, "folder of the third-party scenes")->required();
    app.add_option("--scenes", options.scenes, "folder of our own scenes")->required();
    app.add_option("--json", options.json, "write the numbers to this file");
    app.add_option("--only", options.only, "cornell-box, veach-ajar, living-room or gallery");
    app.add_option("--isa", options.isas, "scalar, v3, v4 (default: the best of this CPU)");
    app.add_option("--sampler", options.sampler, "independent or sobol (default: the scene's)")
        ->check(CLI::IsMember({"independent", "sobol"}));
    app.add_option("--rounds", options.rounds)->capture_default_str()->check(CLI::Range(1, 1000));
    app.add_option("--spp", options.spp, "samples per pixel (default: by time and memory)")
        ->check(CLI::Range(1, 1024));
    app.add_option("--seconds", options.seconds, "about what one render should take")
        ->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    return faceta::bench::run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_floor: %s\n", error.what());
    return 3;
  }
}
