// Sensors, films, samplers and integrators. What is accepted and refused, and numbers called
// Mitsuba's, were read off Mitsuba 3.9.1 (scalar_rgb).
#include "mitsuba_test_tools.h"

namespace faceta {
namespace {

SensorDesc sensor(const std::string& inside) {
  return read_text("<integrator type='path'/><sensor type='perspective'>" + inside + "</sensor>")
      ->sensors.at(0);
}
std::string sensor_error(const std::string& inside) {
  return xml::error_in([&] { sensor(inside); });
}
const std::string kWide = "<film type='hdrfilm'><integer name='width' value='200'/>"
                          "<integer name='height' value='100'/></film>";

TEST(MitsubaSensor, Defaults) {
  SensorDesc s = sensor("");
  EXPECT_NEAR(s.camera.x_fov, 38.18484115600586, 1e-5); // Mitsuba's: 50 mm on 768 x 576
  EXPECT_EQ(s.camera.near_clip, 0.01);
  EXPECT_EQ(s.camera.far_clip, 1e4);
  EXPECT_EQ(s.camera.principal_point[0], 0);
  EXPECT_EQ(s.film.width, 768);
  EXPECT_EQ(s.film.height, 576);
  EXPECT_EQ(s.film.crop_width, 0);
  EXPECT_EQ(s.film.pixel_format, "rgb");
  EXPECT_EQ(s.film.component_format, "float16");
  EXPECT_EQ(s.film.file_format, "openexr");
  EXPECT_EQ(s.film.filter.type, FilterType::gaussian);
  EXPECT_EQ(s.film.filter.stddev, 0.5);
  EXPECT_EQ(s.sampler.type, "sobol"); // ours
  EXPECT_EQ(s.sampler.sample_count, 4);
  EXPECT_EQ(s.sampler.seed, 0u);
}

TEST(MitsubaSensor, FieldOfView) {
  auto fov = [](const std::string& axis) {
    return sensor("<float name='fov' value='40'/><string name='fov_axis' value='" + axis + "'/>" +
                  kWide)
        .camera.x_fov;
  };
  // Mitsuba's x_fov (a float)
  EXPECT_EQ(fov("x"), 40);
  EXPECT_NEAR(fov("y"), 72.10477447509766, 1e-5);
  EXPECT_NEAR(fov("diagonal"), 36.064788818359375, 1e-5);
  EXPECT_NEAR(fov("smaller"), 72.10477447509766, 1e-5);
  EXPECT_EQ(fov("Larger"), 40);
  EXPECT_NEAR(sensor(kWide).camera.x_fov, 42.31171417236328, 1e-5);
  for (const char* length : {"35mm", "35", "35 mm"})
    EXPECT_NEAR(sensor(std::string("<string name='focal_length' value='") + length + "'/>" + kWide)
                    .camera.x_fov,
                57.871192932128906, 1e-5);
  EXPECT_NEAR(sensor("<film type='hdrfilm'><integer name='width' value='100'/>"
                     "<integer name='height' value='200'/></film>")
                  .camera.x_fov,
              21.902137756347656, 1e-5);
  // the crop does not count
  EXPECT_NEAR(sensor("<float name='fov' value='40'/><string name='fov_axis' value='y'/>"
                     "<film type='hdrfilm'><integer name='width' value='200'/>"
                     "<integer name='height' value='100'/>"
                     "<integer name='crop_width' value='50'/></film>")
                  .camera.x_fov,
              72.10477447509766, 1e-5);
}

TEST(MitsubaSensor, FieldOfViewErrors) {
  EXPECT_EQ(sensor_error("<float name='fov' value='40'/><string name='fov_axis' value='z'/>"),
            "s.xml:1:106: error: 'fov_axis' of sensor of type 'perspective' cannot be 'z' (did you "
            "mean 'x'? known: x, y, diagonal, smaller, larger)");
  EXPECT_HAS(sensor_error("<string name='focal_length' value='35cm'/>"),
             "'focal_length' is '35cm', but must be a positive number of millimetres");
  EXPECT_HAS(sensor_error("<float name='focal_length' value='35'/>"), "must be a string");
  EXPECT_HAS(sensor_error("<string name='focal_length' value='35'/><float name='fov' value='4'/>"),
             "a 'fov' or a 'focal_length', not both");
  EXPECT_HAS(sensor_error("<string name='fov_axis' value='x'/>"),
             "unexpected property 'fov_axis'"); // as in Mitsuba, without a fov
  for (const char* value : {"0", "180", "-10", "nan"})
    EXPECT_HAS(sensor_error(std::string("<float name='fov' value='") + value + "'/>"),
               "must lie between 0 and 180");
}

TEST(MitsubaSensor, ClippingAndPlace) {
  SensorDesc s = sensor("<float name='near_clip' value='1'/><integer name='far_clip' value='50'/>"
                        "<float name='focus_distance' value='3'/>"
                        "<float name='principal_point_offset_x' value='.1'/>"
                        "<float name='principal_point_offset_y' value='-.2'/>"
                        "<transform name='to_world'><scale x='-1'/><translate z='4'/></transform>");
  EXPECT_EQ(s.camera.near_clip, 1);
  EXPECT_EQ(s.camera.far_clip, 50);
  EXPECT_EQ(s.camera.principal_point[0], 0.1);
  EXPECT_EQ(s.camera.principal_point[1], -0.2);
  EXPECT_EQ(s.camera.to_world[0], -1); // mirrors are allowed
  EXPECT_EQ(s.camera.to_world[11], 4);
  EXPECT_HAS(sensor_error("<float name='near_clip' value='0'/>"), "must be positive");
  EXPECT_HAS(sensor_error("<float name='near_clip' value='10'/><float name='far_clip' value='1'/>"),
             "'near_clip' (10) must be smaller than 'far_clip' (1)");
  for (const char* value : {"2", "1.0005"})
    EXPECT_EQ(sensor_error(std::string("<transform name='to_world'><scale value='") + value +
                           "'/></transform>"),
              "s.xml:1:76: error: a camera's to_world must not scale or shear");
  EXPECT_HAS(
      sensor_error("<transform name='to_world'><matrix value='1 .5 0 0 0 1 0 0 0 0 1 0 0 0 0 "
                   "1'/></transform>"),
      "must not scale or shear");
  EXPECT_HAS(sensor_error("<float name='shutter_open' value='1'/>"), "'shutter_open'");
  EXPECT_HAS(sensor_error("<spectrum name='srf' value='1'/>"), "spectral");
  EXPECT_HAS(sensor_error("<medium type='homogeneous'/>"), "not supported yet");
  EXPECT_HAS(sensor_error("<float name='aperture_radius' value='1'/>"),
             "unexpected property 'aperture_radius'");
  EXPECT_HAS(sensor_error("<film type='hdrfilm'/><film type='hdrfilm'/>"), "more than one film");
  EXPECT_HAS(sensor_error("<sampler type='sobol'/><sampler type='sobol'/>"),
             "more than one sampler");
}

TEST(MitsubaSensor, SensorsKeepTheirOrder) {
  auto scene = read_text("<sensor type='perspective' id='a'/><integrator type='path'/>"
                         "<sensor type='perspective' id='b'><float name='fov' value='20'/>"
                         "</sensor>");
  ASSERT_EQ(scene->sensors.size(), 2u);
  EXPECT_EQ(scene->sensors[0].id, "a");
  EXPECT_EQ(scene->sensors[1].id, "b");
  EXPECT_EQ(scene->sensors[1].camera.x_fov, 20);
}

FilmDesc film(const std::string& inside) {
  return sensor("<film type='hdrfilm'>" + inside + "</film>").film;
}
std::string film_error(const std::string& inside) {
  return xml::error_in([&] { film(inside); });
}
std::string word(const std::string& name, const std::string& value) {
  return "<string name='" + name + "' value='" + value + "'/>";
}
std::string whole(const std::string& name, int value) {
  return "<integer name='" + name + "' value='" + std::to_string(value) + "'/>";
}

TEST(MitsubaFilm, Properties) {
  FilmDesc f = film(whole("width", 40) + whole("height", 30) + whole("crop_offset_x", 10) +
                    whole("crop_width", 20) + word("pixel_format", "RGBA") +
                    word("component_format", "Float32") + word("file_format", "EXR") +
                    "<boolean name='banner' value='false'/><float name='compensate' value='1'/>"
                    "<boolean name='sample_border' value='false'/>");
  EXPECT_EQ(f.width, 40);
  EXPECT_EQ(f.height, 30);
  EXPECT_EQ(f.crop_x, 10);
  EXPECT_EQ(f.crop_y, 0);
  EXPECT_EQ(f.crop_width, 20);
  EXPECT_EQ(f.crop_height, 30);
  EXPECT_EQ(f.pixel_format, "rgba");
  EXPECT_EQ(f.component_format, "float32");
  EXPECT_EQ(f.file_format, "openexr");
  EXPECT_HAS(film_error("<float name='width' value='3'/>"), "must be an integer");
  EXPECT_HAS(film_error(whole("width", 0)), "must lie between 1 and");
  EXPECT_HAS(film_error(whole("width", 65537)), "must lie between 1 and 65536");
  EXPECT_HAS(film_error(whole("width", 65536) + whole("height", 65536)), "s.xml:1:");
  EXPECT_HAS(film_error(whole("crop_offset_x", 10)), // as in Mitsuba
             "the crop window of 768 x 576 at (10, 0) leaves the film of 768 x 576");
  EXPECT_HAS(film_error(word("pixel_format", "rgbb")), "cannot be 'rgbb' (did you mean 'rgb'?");
  EXPECT_HAS(film_error(word("file_format", "png")), "cannot be 'png'");
  EXPECT_HAS(film_error(word("component_format", "half")), "cannot be 'half'");
  EXPECT_HAS(film_error("<float name='gamma' value='1'/>"), "unexpected property 'gamma'");
  EXPECT_HAS(film_error("<boolean name='sample_border' value='true'/>"),
             "'sample_border' of film 'hdrfilm' is not supported yet");
  EXPECT_HAS(film_error("<rfilter type='box'/><rfilter type='box'/>"), "more than one rfilter");
}

TEST(MitsubaFilm, Filters) {
  EXPECT_EQ(film("<rfilter type='box'/>").filter.type, FilterType::box);
  FilterDesc tent = film("<rfilter type='tent'><float name='radius' value='2'/></rfilter>").filter;
  EXPECT_EQ(tent.type, FilterType::tent);
  EXPECT_EQ(tent.radius, 2);
  EXPECT_EQ(
      film("<rfilter type='gaussian'><float name='stddev' value='.7'/></rfilter>").filter.stddev,
      0.7);
  EXPECT_HAS(film_error("<rfilter type='box'><float name='radius' value='2'/></rfilter>"),
             "unexpected property 'radius' in rfilter of type 'box'");
  EXPECT_HAS(film_error("<rfilter type='tent'><float name='radius' value='0'/></rfilter>"),
             "must be positive");
  for (const char* name : {"mitchell", "catmullrom", "lanczos"})
    EXPECT_HAS(film_error(std::string("<rfilter type='") + name + "'/>"),
               std::string("rfilter '") + name +
                   "' is not supported yet (supported: box, tent, gaussian)");
}

TEST(MitsubaSampler, Samplers) {
  SamplerDesc s = sensor("<sampler type='independent'>" + whole("sample_count", 64) +
                         "<integer name='seed' value='4294967295'/></sampler>")
                      .sampler;
  EXPECT_EQ(s.type, "independent");
  EXPECT_EQ(s.sample_count, 64);
  EXPECT_EQ(s.seed, 4294967295u);
  EXPECT_EQ(sensor("<sampler type='sobol'/>").sampler.sample_count, 4);
  EXPECT_HAS(sensor_error("<sampler type='independent'><integer name='seed' value='4294967296'/>"
                          "</sampler>"),
             "must lie between 0 and 4294967295");
  EXPECT_HAS(sensor_error("<sampler type='independent'>" + whole("sample_count", 0) + "</sampler>"),
             "must lie between 1");
  EXPECT_HAS(sensor_error("<sampler type='independent'><float name='sample_count' value='7'/>"
                          "</sampler>"),
             "must be an integer");
  EXPECT_HAS(sensor_error("<sampler type='independent'><boolean name='jitter' value='true'/>"
                          "</sampler>"),
             "unexpected property 'jitter'");
  for (const char* name : {"stratified", "multijitter", "orthogonal", "ldsampler"})
    EXPECT_HAS(sensor_error(std::string("<sampler type='") + name + "'/>"),
               std::string("sampler '") + name + "' is not supported yet");
}

IntegratorDesc integrator(const std::string& text) {
  return read_text("<sensor type='perspective'/>" + text)->integrator;
}
std::string integrator_error(const std::string& text) {
  return xml::error_in([&] { integrator(text); });
}

TEST(MitsubaIntegrator, Path) {
  IntegratorDesc p = integrator("<integrator type='path'/>");
  EXPECT_EQ(p.type, "path");
  EXPECT_EQ(p.max_depth, -1);
  EXPECT_EQ(p.rr_depth, 5);
  EXPECT_FALSE(p.hide_emitters || p.moments);
  EXPECT_EQ(p.timeout, -1);
  p = integrator("<integrator type='path'>" + whole("max_depth", 0) + whole("rr_depth", 9) +
                 whole("block_size", 32) + whole("samples_per_pass", 4) + whole("timeout", 3) +
                 "<boolean name='hide_emitters' value='true'/></integrator>");
  EXPECT_EQ(p.max_depth, 0);
  EXPECT_EQ(p.rr_depth, 9);
  EXPECT_TRUE(p.hide_emitters);
  EXPECT_EQ(p.timeout, 3);
  auto error = [](const std::string& inside) {
    return integrator_error("<integrator type='path'>" + inside + "</integrator>");
  };
  EXPECT_HAS(error(whole("max_depth", -2)), "'max_depth' of integrator of type 'path' is -2");
  EXPECT_HAS(error(whole("rr_depth", 0)), "'rr_depth' of integrator of type 'path' is 0");
  EXPECT_HAS(error(whole("block_size", -1)), "must lie between 0");
  EXPECT_HAS(error("<float name='max_depth' value='3'/>"), "must be an integer, not a float");
  EXPECT_HAS(error("<boolean name='strict_normals' value='true'/>"),
             "unexpected property 'strict_normals'");
}

TEST(MitsubaIntegrator, Direct) {
  auto counts = [](const std::string& inside) {
    IntegratorDesc d = integrator("<integrator type='direct'>" + inside + "</integrator>");
    EXPECT_EQ(d.type, "direct");
    return std::pair(d.emitter_samples, d.bsdf_samples);
  };
  // Mitsuba's counts
  EXPECT_EQ(counts(""), std::pair(1, 1));
  EXPECT_EQ(counts(whole("shading_samples", 4)), std::pair(4, 4));
  EXPECT_EQ(counts(whole("emitter_samples", 0)), std::pair(0, 1));
  EXPECT_EQ(counts(whole("emitter_samples", 2)), std::pair(2, 1));
  auto error = [](const std::string& inside) {
    return integrator_error("<integrator type='direct'>" + inside + "</integrator>");
  };
  EXPECT_HAS(error(whole("shading_samples", 2) + whole("bsdf_samples", 1)),
             "'shading_samples' and 'bsdf_samples'");
  EXPECT_HAS(error(whole("shading_samples", 2) + whole("emitter_samples", 1)),
             "'shading_samples' and 'emitter_samples'");
  EXPECT_HAS(error(whole("shading_samples", 0)), "at least one sample");
  EXPECT_HAS(error(whole("bsdf_samples", -1)), "must lie between 0");
  EXPECT_HAS(error(whole("max_depth", 2)), "unexpected property 'max_depth'");
}

TEST(MitsubaIntegrator, Moment) {
  IntegratorDesc m = integrator("<integrator type='moment'><integrator type='path'>" +
                                whole("max_depth", 2) + "</integrator></integrator>");
  EXPECT_EQ(m.type, "path");
  EXPECT_EQ(m.max_depth, 2);
  EXPECT_TRUE(m.moments);
  EXPECT_EQ(m.moment_name, "_arg_0"); // Mitsuba's channels: _arg_0.X ... m2__arg_0.Z
  m = integrator("<integrator type='moment'><integrator type='direct' name='foo' id='bar'/>" +
                 whole("block_size", 32) + whole("timeout", 7) + "</integrator>");
  EXPECT_EQ(m.type, "direct");
  EXPECT_EQ(m.moment_name, "foo");
  EXPECT_EQ(m.timeout, 7);
  EXPECT_HAS(integrator_error("<integrator type='moment'/>"), "needs an integrator inside");
  EXPECT_HAS(integrator_error("<integrator type='moment'><integrator type='path'/>"
                              "<integrator type='direct'/></integrator>"),
             "more than one integrator inside a moment integrator is not supported yet");
  EXPECT_HAS(integrator_error("<integrator type='moment'><integrator type='moment'>"
                              "<integrator type='path'/></integrator></integrator>"),
             "inside another is not supported yet");
  EXPECT_HAS(integrator_error("<integrator type='moment'><integrator type='depth'/></integrator>"),
             "s.xml:1:78: error: integrator 'depth' is not supported yet");
  EXPECT_HAS(integrator_error("<integrator type='moment'><integrator type='path'/>"
                              "<bsdf type='diffuse'/></integrator>"),
             "unexpected bsdf");
}

} // namespace
} // namespace faceta
