#include "cli/render_command.h"

#include "cli/commands.h"
#include "cli/progress.h"
#include "formats/mitsuba_scene.h"
#include "image/io.h"
#include "render/picture.h"

#include <cstdio>
#include <filesystem>

namespace faceta::cli {

namespace {

namespace fs = std::filesystem;

/// The sensor asked for, with size and crop replaced by the command line's.
SensorDesc choose_sensor(const Scene& scene, const RenderOptions& options) {
  int count = static_cast<int>(scene.sensors.size());
  if (options.sensor < 0 || options.sensor >= count)
    throw Error("the scene has no sensor " + std::to_string(options.sensor), {options.scene},
                "it has " + std::to_string(count) + ", counted from 0");
  SensorDesc sensor = scene.sensors[options.sensor];
  FilmDesc& film = sensor.film;
  if (options.size) {
    film.width = (*options.size)[0];
    film.height = (*options.size)[1];
    film.crop_x = film.crop_y = film.crop_width = film.crop_height = 0;
  }
  if (options.crop) {
    const auto& c = *options.crop;
    film.crop_x = c[0];
    film.crop_y = c[1];
    film.crop_width = c[2];
    film.crop_height = c[3];
  }
  if (film.crop_width == 0)
    film.crop_width = film.width - film.crop_x;
  if (film.crop_height == 0)
    film.crop_height = film.height - film.crop_y;
  if (film.crop_x < 0 || film.crop_y < 0 || film.crop_width <= 0 || film.crop_height <= 0 ||
      film.crop_x + film.crop_width > film.width || film.crop_y + film.crop_height > film.height)
    throw Error("the crop window lies outside the picture of " + std::to_string(film.width) +
                    " x " + std::to_string(film.height) + " pixels",
                {options.scene});
  if (options.spp)
    sensor.sampler.sample_count = *options.spp;
  if (options.seed)
    sensor.sampler.seed = *options.seed;
  if (!options.sampler.empty())
    sensor.sampler.type = options.sampler;
  return sensor;
}

std::string default_output(const std::string& scene, const FilmDesc& film) {
  const char* ending = film.file_format == "pfm"    ? ".pfm"
                       : film.file_format == "rgbe" ? ".hdr"
                                                    : ".exr";
  return fs::path(scene).replace_extension(ending).string();
}

void write_outputs(const RenderOptions& options, const SensorDesc& sensor, const Scene& scene,
                   const RenderResult& result) {
  PictureFacts facts{options.scene, FACETA_VERSION, "faceta render", sensor.sampler.seed};
  Image picture = make_picture(result, sensor.film, scene.integrator, facts);
  std::vector<std::string> outputs = options.outputs;
  if (outputs.empty())
    outputs.push_back(default_output(options.scene, sensor.film));
  WriteOptions write;
  write.half = !options.full_floats && sensor.film.component_format == "float16";
  write.exposure = options.exposure;
  for (const std::string& output : outputs) {
    bool exr = fs::path(output).extension() == ".exr";
    write_image(output, exr ? picture : rgb_picture(result), write);
    if (options.verbosity >= 0)
      std::fprintf(stderr, "wrote %s\n", output.c_str());
  }
  if (!options.variance.empty()) {
    WriteOptions exact;
    exact.half = false;
    write_image(options.variance, result.film.variance(), exact);
  }
}

void report(const RenderResult& r, const SceneStatistics& s) {
  const RenderCounters& c = r.counters;
  double rays = double(c.camera_rays + c.closest_rays + c.shadow_rays);
  std::fprintf(stderr,
               "%zu triangles, %zu quadrics, %zu lights, %zu textures, %zu materials\n"
               "%.2f s, %.2f M samples/s, %.1f Mrays/s, %.2f rays a sample, %.2f vertices a path\n",
               s.triangles, s.quadrics, s.lights, s.textures, s.materials, r.seconds,
               double(c.paths) / r.seconds * 1e-6, rays / r.seconds * 1e-6, rays / double(c.paths),
               double(c.vertices) / double(c.paths));
}

} // namespace

int run_render(const RenderOptions& options) {
  ReadOptions read;
  read.defines = options.defines;
  read.permissive = options.permissive;
  read.warn = [&](const std::string& text) {
    if (options.verbosity >= 0)
      std::fprintf(stderr, "%s\n", text.c_str());
  };
  for (const std::string& output : options.outputs)
    if (!can_write_image(output))
      throw Error("no writer for this ending", {output}, "known: .exr, .png, .pfm, .hdr");
  std::unique_ptr<Scene> scene = read_mitsuba_scene(options.scene, read);
  SensorDesc sensor = choose_sensor(*scene, options);
  faceta::RenderOptions job;
  job.isa = options.isa.value_or(best_isa());
  scene->build(job.isa);
  scene->use_sensor(sensor.camera, sensor.film);
  job.spp = sensor.sampler.sample_count;
  job.settings = render_settings(scene->integrator, sensor.sampler);
  job.threads = options.threads;
  job.tile = options.tile;
  job.moments = scene->integrator.moments;
  job.timeout = scene->integrator.timeout;
  ProgressLine line(options.verbosity < 0);
  InterruptFlag interrupt;
  job.stop = &interrupt.flag();
  job.progress = [&](const Progress& p) { line.update(p); };
  RenderResult result = faceta::render(*scene, job);
  line.finish();
  if (result.stopped && options.verbosity >= 0)
    std::fprintf(stderr, "stopped after %lld of %d samples a pixel\n",
                 static_cast<long long>(result.film.samples), job.spp);
  if (result.film.non_finite)
    std::fprintf(stderr, "warning: %llu samples were not finite and count as 0\n",
                 static_cast<unsigned long long>(result.film.non_finite));
  if (options.verbosity > 0)
    report(result, scene->statistics());
  write_outputs(options, sensor, *scene, result);
  return kOk;
}

} // namespace faceta::cli
