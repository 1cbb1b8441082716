// Writes the seeds that are binary: small pictures in every way that a format stores them, made by
// the formats' own libraries, meshes, and files of measured reflectance.
//   make_seeds FOLDER      writes FOLDER/fuzz_<target>/<name>

#include "formats/measured_rgl.h"
#include "formats/measured_tensor.h"
#include "image/codecs.h"

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <cstdio>
#include <cstdlib>
#include <fmt/format.h>
#include <jpeglib.h>
#include <png.h>

using namespace faceta;
namespace fs = std::filesystem;

namespace {

constexpr int kWidth = 10, kHeight = 6; // even, as sub-sampled chroma wants

fs::path place(const fs::path& folder, const std::string& target, const std::string& name) {
  fs::create_directories(folder / ("fuzz_" + target));
  return folder / ("fuzz_" + target) / name;
}

void write(const fs::path& path, const std::string& bytes) {
  codec::write_file(path, {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

Image picture(std::vector<std::string> channels) {
  Image image(kWidth, kHeight, std::move(channels));
  for (std::size_t i = 0; i < image.data.size(); ++i)
    image.data[i] = static_cast<float>(i % 7) / 4;
  return image;
}

void write_exr_kind(const fs::path& path, Imf::Compression compression, Imf::PixelType type,
                    bool tiled) {
  Imf::Header header(kWidth, kHeight);
  header.compression() = compression;
  std::vector<std::uint32_t> values(3 * kWidth * kHeight, 0x3c003c00);
  const std::size_t size = type == Imf::HALF ? 2 : 4;
  Imf::FrameBuffer frame;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::string name(1, "RGB"[c]);
    header.channels().insert(name, Imf::Channel(type));
    frame.insert(name, Imf::Slice(type, reinterpret_cast<char*>(values.data()) + c * size, 3 * size,
                                  3 * size * kWidth));
  }
  if (tiled) {
    header.setTileDescription(Imf::TileDescription(4, 4, Imf::MIPMAP_LEVELS));
    Imf::TiledOutputFile out(path.c_str(), header, 0);
    out.setFrameBuffer(frame);
    for (int level = 0; level < out.numLevels(); ++level)
      out.writeTiles(0, out.numXTiles(level) - 1, 0, out.numYTiles(level) - 1, level);
    return;
  }
  Imf::OutputFile out(path.c_str(), header, 0);
  out.setFrameBuffer(frame);
  out.writePixels(kHeight);
}

void write_exr_parts(const fs::path& path) {
  std::vector<Imf::Header> headers;
  for (const char* part : {"left", "right"}) {
    Imf::Header header(4, 3);
    if (std::string(part) == "right")
      header.dataWindow().min.x = 2;
    header.setName(part);
    header.setType(Imf::SCANLINEIMAGE);
    header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
    headers.push_back(header);
  }
  std::vector<float> values(12, 1.0f);
  Imf::MultiPartOutputFile out(path.c_str(), headers.data(), 2, false, 0);
  for (int part = 0; part < 2; ++part) {
    Imf::OutputPart writer(out, part);
    Imf::FrameBuffer frame;
    frame.insert("Y", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), 4, 16));
    writer.setFrameBuffer(frame);
    writer.writePixels(3);
  }
}

void write_exr_seeds(const fs::path& folder) {
  for (int c = Imf::NO_COMPRESSION; c < Imf::NUM_COMPRESSION_METHODS; ++c)
    for (bool tiled : {false, true})
      for (auto type : {Imf::HALF, Imf::FLOAT, Imf::UINT})
        if (type == Imf::HALF || c % 4 == type)
          write_exr_kind(place(folder, "exr", fmt::format("{}-{}-{}.exr", c, int(type), tiled)),
                         Imf::Compression(c), type, tiled);
  write_exr_parts(place(folder, "exr", "parts.exr"));
  Imf::RgbaOutputFile chroma(place(folder, "exr", "chroma.exr").c_str(), kWidth, kHeight,
                             Imf::WRITE_YCA);
  const std::vector<Imf::Rgba> pixels(kWidth * kHeight, Imf::Rgba(0.5f, 0.25f, 0.125f, 1));
  chroma.setFrameBuffer(pixels.data(), 1, kWidth);
  chroma.writePixels(kHeight);
  Image image = picture({"R", "G", "B", "A", "depth"});
  image.metadata = {{"spp", 4},
                    {"time", 1.5},
                    {"eye", V3f{1, 2, 3}},
                    {"to_world", M44f{}},
                    {"chromaticities", Chromaticities{}},
                    {"name of it", std::string("x")}};
  write_image(place(folder, "exr", "metadata.exr"), image);
}

void write_png_kind(const fs::path& path, int colour, int depth, int interlace) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, file);
  png_set_IHDR(png, info, kWidth, kHeight, depth, colour, interlace, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  const png_color palette[2] = {{10, 20, 30}, {200, 100, 50}};
  const png_byte alpha[2] = {0, 255};
  if (colour == PNG_COLOR_TYPE_PALETTE) {
    png_set_PLTE(png, info, palette, 2);
    png_set_tRNS(png, info, alpha, 2, nullptr);
  }
  png_set_gAMA(png, info, 0.5);
  png_write_info(png, info);
  std::vector<png_byte> row(kWidth * 8); // palettes have few entries
  std::vector<png_bytep> rows(kHeight, row.data());
  png_write_image(png, rows.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  std::fclose(file);
}

void write_png_seeds(const fs::path& folder) {
  for (int colour : {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_RGB, PNG_COLOR_TYPE_RGB_ALPHA,
                     PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_PALETTE})
    for (int depth : {1, 2, 4, 8, 16}) {
      const bool small = colour == PNG_COLOR_TYPE_GRAY || colour == PNG_COLOR_TYPE_PALETTE;
      if ((depth < 8 && !small) || (depth == 16 && colour == PNG_COLOR_TYPE_PALETTE))
        continue;
      for (int interlace : {PNG_INTERLACE_NONE, PNG_INTERLACE_ADAM7})
        write_png_kind(place(folder, "png", fmt::format("{}-{}-{}.png", colour, depth, interlace)),
                       colour, depth, interlace);
    }
}

void write_jpeg_seed(const fs::path& path, J_COLOR_SPACE space, bool progressive, bool arithmetic) {
  jpeg_compress_struct jpeg;
  jpeg_error_mgr errors;
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* data = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &data, &size);
  jpeg.image_width = 2 * kWidth, jpeg.image_height = 2 * kHeight;
  jpeg.input_components = space == JCS_GRAYSCALE ? 1 : 3;
  jpeg.in_color_space = space;
  jpeg_set_defaults(&jpeg);
  jpeg.arith_code = arithmetic ? TRUE : FALSE;
  jpeg.restart_interval = progressive ? 0 : 1;
  if (progressive)
    jpeg_simple_progression(&jpeg);
  jpeg_start_compress(&jpeg, TRUE);
  codec::Bytes row(std::size_t(2 * kWidth * jpeg.input_components));
  for (int y = 0; y < 2 * kHeight; ++y) {
    for (std::size_t i = 0; i < row.size(); ++i)
      row[i] = std::uint8_t(7 * i + 11 * std::size_t(y));
    JSAMPROW pointer = row.data();
    jpeg_write_scanlines(&jpeg, &pointer, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  codec::write_file(path, {data, size});
  std::free(data);
}

void write_jpeg_seeds(const fs::path& folder) {
  for (auto space : {JCS_GRAYSCALE, JCS_RGB})
    for (bool progressive : {false, true})
      for (bool arithmetic : {false, true})
        write_jpeg_seed(
            place(folder, "jpeg", fmt::format("{}-{}-{}.jpg", int(space), progressive, arithmetic)),
            space, progressive, arithmetic);
}

void write_float_seeds(const fs::path& folder) {
  write_image(place(folder, "hdr", "runs.hdr"), picture({"R", "G", "B"}));
  const std::string head = "#?RADIANCE\n# made by hand\nEXPOSURE=2\nFORMAT=32-bit_rle_xyze\n\n";
  write(place(folder, "hdr", "plain.hdr"), head + "+X 2 -Y 3\n" + std::string(24, '\x81'));
  write(place(folder, "hdr", "old-runs.hdr"), head + "-Y 1 +X 9\n\x80\x40\x20\x81\x01\x01\x01\x08");
  write_image(place(folder, "pfm", "colour.pfm"), picture({"R", "G", "B"}));
  write_image(place(folder, "pfm", "grey.pfm"), picture({"Y"}));
  write(place(folder, "pfm", "big-endian.pfm"), "Pf\n2 1\n3.5\n\x3f\x80" + std::string(6, '\0'));
}

void write_ply_seeds(const fs::path& folder) {
  for (bool big : {false, true}) {
    std::string text = fmt::format(
        "ply\nformat binary_{}_endian 1.0\nelement vertex 3\nproperty float x\n"
        "property double y\nproperty half z\nproperty char flag\nelement face 1\n"
        "property list uchar int vertex_indices\nproperty list short uint8 more\nend_header\n",
        big ? "big" : "little");
    for (int vertex = 0; vertex < 3; ++vertex)
      text += std::string(vertex == 1 ? 1 : 4, '\x3f') + std::string(vertex == 1 ? 14 : 11, '\0');
    const std::string one = big ? std::string("\0\0\0\1", 4) : std::string("\1\0\0\0", 4);
    const std::string two = big ? std::string("\0\0\0\2", 4) : std::string("\2\0\0\0", 4);
    text += "\3" + std::string(4, '\0') + one + two + std::string(big ? "\0\1x" : "\1\0x", 3);
    write(place(folder, "ply", big ? "big-endian.ply" : "little-endian.ply"), text);
  }
}

template <class T> void put(std::string& out, const std::vector<T>& values) {
  out.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

template <class T> TensorField field(const char* name, TensorType type,
                                     std::vector<std::uint64_t> shape,
                                     const std::vector<T>& values) {
  return {name,
          type,
          std::move(shape),
          {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)}};
}

void write_tensor_seeds(const fs::path& folder) {
  RglTables t;
  t.phi_i = {0}, t.theta_i = {0, 1};
  for (int axis = 0; axis < 2; ++axis)
    t.ndf_size[axis] = t.sigma_size[axis] = t.vndf_size[axis] = t.luminance_size[axis] = 2;
  t.ndf = t.sigma = {1, 2, 3, 4};
  t.vndf = t.luminance = {1, 2, 3, 4, 5, 6, 7, 8};
  t.rgb.assign(24, 0.5f);
  write_rgl(place(folder, "measured", "colours.bsdf"), t, "made by hand");
  const std::vector<float> two = {0, 1}, four = {1, 2, 3, 4}, eight = {1, 2, 3, 4, 5, 6, 7, 8};
  const std::vector<float> phi = {0}, wavelengths = {500, 600, 700}, spectra(24, 0.5f);
  const std::vector<std::uint8_t> one = {1};
  using enum TensorType;
  write_tensor_file(
      place(folder, "measured", "spectra.bsdf"),
      {field("phi_i", f32, {1}, phi), field("theta_i", f32, {2}, two),
       field("sigma", f32, {2, 2}, four), field("ndf", f32, {2, 2}, four),
       field("vndf", f32, {1, 2, 2, 2}, eight), field("luminance", f32, {1, 2, 2, 2}, eight),
       field("wavelengths", f32, {3}, wavelengths), field("spectra", f32, {1, 2, 3, 2, 2}, spectra),
       field("jacobian", u8, {1}, one)});
  const std::vector<float> phi_d = {-3.14159265f, 0, 3.14159265f}, mueller(3 * 2 * 1 * 2 * 16, 1);
  const std::vector<std::uint16_t> wvls = {450, 650};
  write_tensor_file(place(folder, "measured", "mueller.pbsdf"),
                    {field("theta_h", f32, {1, 1}, phi), field("theta_d", f32, {1, 2}, two),
                     field("phi_d", f32, {1, 3}, phi_d), field("wvls", u16, {2}, wvls),
                     field("M", f32, {3, 2, 1, 2, 4, 4}, mueller)});
}

void write_measured_seeds(const fs::path& folder) {
  write_tensor_seeds(folder);
  std::string merl, ngan, mbsdf = "NVIDIA ARC MBSDF V1\na=\"b\"\n";
  put<std::int32_t>(merl, {2, 2, 3});
  put(merl, std::vector<double>(36, 1500));
  write(place(folder, "measured", "small.binary"), merl);
  put<std::int32_t>(ngan, {2, 2, 2, 3, 0, 0, 1, 0, 0, 1, 3, 0, 0, 0, 0, 0});
  put(ngan, std::vector<float>(72, 0.25f));
  write(place(folder, "measured", "small.dat"), ngan);
  for (std::uint32_t type : {1u, 0u}) {
    mbsdf += type == 1 ? "MBSDF_DATA_REFLECTION=\n" : "MBSDF_DATA_TRANSMISSION=\n";
    put<std::uint32_t>(mbsdf, {type, 2, 3});
    put(mbsdf, std::vector<float>(type == 1 ? 36 : 12, -0.5f));
  }
  write(place(folder, "measured", "small.mbsdf"), mbsdf);
  write_image(place(folder, "measured", "small.exr"), picture({"R", "G", "B"}));
}

} // namespace

int main(int count, char** arguments) {
  if (count != 2) {
    std::fprintf(stderr, "usage: make_seeds FOLDER\n");
    return 2;
  }
  const fs::path folder = arguments[1];
  write_exr_seeds(folder);
  write_png_seeds(folder);
  write_jpeg_seeds(folder);
  write_float_seeds(folder);
  write_ply_seeds(folder);
  write_measured_seeds(folder);
  return 0;
}
