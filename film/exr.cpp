#include "film/exr.h"

#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfInputPart.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <array>
#include <exception>
#include <filesystem>

#include "film/atomic_file.h"
#include "proto/status.h"

namespace penumbra {
namespace {

using Names = std::array<const char*, 3>;
constexpr Names kRgb = {"R", "G", "B"};
constexpr Names kGrey = {"Y", "Y", "Y"};
constexpr Names kVariance = {"variance.R", "variance.G", "variance.B"};
constexpr Names kStandardError = {"stderr.R", "stderr.G", "stderr.B"};

/// An EXR in memory, so that only write_file_atomically meets the disk.
class MemoryStream final : public Imf::OStream {
 public:
  MemoryStream() : OStream("memory") {}
  void write(const char* bytes, int count) override {
    const size_t end = position_ + static_cast<size_t>(count);
    if (bytes_.size() < end) bytes_.resize(end);
    std::copy_n(bytes, count, bytes_.begin() + static_cast<std::ptrdiff_t>(position_));
    position_ = end;
  }
  uint64_t tellp() override { return position_; }
  void seekp(uint64_t position) override { position_ = position; }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  size_t position_ = 0;
};

/// OpenEXR addresses a pixel (x, y) of the data window as base + x * xstride + y * ystride, so that the
/// base is where pixel (0, 0) would lie; formed as an integer, because it may lie outside the array.
Imf::Slice slice(const float* first, const Imath::Box2i& window, size_t channels) {
  const auto xstride = static_cast<int64_t>(channels * sizeof(float));
  const int64_t ystride = xstride * (int64_t{window.max.x} - window.min.x + 1);
  const auto address = reinterpret_cast<intptr_t>(first) - window.min.x * xstride - window.min.y * ystride;
  return {Imf::FLOAT, reinterpret_cast<char*>(address), static_cast<size_t>(xstride),
          static_cast<size_t>(ystride)};
}

void insert_three(Imf::FrameBuffer& buffer, const Names& names, const std::vector<float>& values,
                  const Imath::Box2i& window) {
  for (size_t c = 0; c < 3; ++c) buffer.insert(names[c], slice(values.data() + c, window, 3));
}

std::string bin_name(int bin) {
  return fmt::format("bin.{:03}", bin);
}

Imf::Header make_header(const FilmImage& image, const ExrHeader& from) {
  const PixelRect& w = image.window;
  const Imath::Box2i display({0, 0}, {image.width - 1, image.height - 1});
  const Imath::Box2i data({w.x0, w.y0}, {w.x1 - 1, w.y1 - 1});
  Imf::Header header(display, data, 1, {0, 0}, 1, Imf::INCREASING_Y, Imf::ZIP_COMPRESSION);
  header.insert("penumbra:mix", Imf::StringAttribute(from.mix));
  header.insert("penumbra:cpu_seconds", Imf::FloatAttribute(static_cast<float>(from.cpu_seconds)));
  header.insert("penumbra:scene", Imf::StringAttribute(from.scene));
  header.insert("penumbra:seed", Imf::StringAttribute(fmt::format("{}", from.seed)));
  header.insert("penumbra:version", Imf::StringAttribute(PENUMBRA_VERSION));
  if (from.partial) header.insert("penumbra:partial", Imf::IntAttribute(1));
  if (const auto& t = from.transient)
    header.insert("penumbra:transient", Imf::StringAttribute(fmt::format("{},{},{}", t->t0, t->t1, t->bins)));
  return header;
}

/// The header of a part that holds one bin.
Imf::Header make_bin_header(const FilmImage& image, const Transient& transient, int bin) {
  const Imath::Box2i display({0, 0}, {image.width - 1, image.height - 1});
  const PixelRect& w = image.window;
  Imf::Header header(display, {{w.x0, w.y0}, {w.x1 - 1, w.y1 - 1}}, 1, {0, 0}, 1, Imf::INCREASING_Y,
                     Imf::ZIP_COMPRESSION);
  header.insert("penumbra:t0", Imf::DoubleAttribute(transient.edge(bin)));
  header.insert("penumbra:t1", Imf::DoubleAttribute(transient.edge(bin + 1)));
  header.setName(bin_name(bin));
  return header;
}

Imf::FrameBuffer make_buffer(const FilmImage& image, const Imath::Box2i& window) {
  Imf::FrameBuffer buffer;
  insert_three(buffer, kRgb, image.rgb, window);
  if (!image.variance.empty()) insert_three(buffer, kVariance, image.variance, window);
  if (!image.samples.empty()) buffer.insert("samples", slice(image.samples.data(), window, 1));
  if (!image.cost.empty()) buffer.insert("cost", slice(image.cost.data(), window, 1));
  return buffer;
}

bool has(const Imf::Header& header, const Names& names) {
  return std::all_of(names.begin(), names.end(),
                     [&](const char* name) { return header.channels().findChannel(name) != nullptr; });
}

std::string channel_names(const Imf::Header& header) {
  std::string names;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
    names += fmt::format("{}{}", names.empty() ? "" : " ", c.name());
  return names;
}

/// The shape of the image that a header promises, or why it is not read.
absl::StatusOr<FilmImage> shape_of(const Imf::Header& header) {
  const Imath::Box2i& display = header.displayWindow();
  const Imath::Box2i& data = header.dataWindow();
  const auto edge = [](int min, int max) { return int64_t{max} - min + 1; };
  const int64_t width = edge(display.min.x, display.max.x), height = edge(display.min.y, display.max.y);
  const int64_t data_width = edge(data.min.x, data.max.x), data_height = edge(data.min.y, data.max.y);
  for (const auto& [w, h] : {std::pair{width, height}, std::pair{data_width, data_height}})
    if (w < 1 || h < 1 || w > kMostImageEdge || h > kMostImageEdge || w * h > kMostImagePixels)
      return invalid_input("{}x{} pixels; at most {} a side and {} in all are read", w, h, kMostImageEdge,
                           kMostImagePixels);
  FilmImage image;
  image.width = static_cast<int>(width);
  image.height = static_cast<int>(height);
  const int64_t x0 = int64_t{data.min.x} - display.min.x, y0 = int64_t{data.min.y} - display.min.y;
  if (x0 < -kMostImageEdge || y0 < -kMostImageEdge || x0 > kMostImageEdge || y0 > kMostImageEdge)
    return invalid_input("the data window lies at {},{}, far from the image", x0, y0);
  image.window = {static_cast<int>(x0), static_cast<int>(y0), static_cast<int>(x0 + data_width),
                  static_cast<int>(y0 + data_height)};
  return image;
}

void add_three(Imf::FrameBuffer& buffer, const Names& names, FilmImage& image, std::vector<float>& values,
               const Imath::Box2i& window) {
  values.resize(3 * image.pixels());
  insert_three(buffer, names, values, window);
}

void add_one(Imf::FrameBuffer& buffer, const char* name, const FilmImage& image, std::vector<float>& values,
             const Imath::Box2i& window) {
  values.resize(image.pixels());
  buffer.insert(name, slice(values.data(), window, 1));
}

absl::Status check_sampling(const Imf::Header& header) {
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
    if (c.channel().xSampling != 1 || c.channel().ySampling != 1)
      return invalid_input("channel {} is subsampled (luminance/chroma files are not read)", c.name());
  return absl::OkStatus();
}

/// A file's only or first part, or one of several (Imf::InputFile, Imf::InputPart). May throw what OpenEXR
/// throws.
template <class File>
absl::StatusOr<FilmImage> read_part(File& file) {
  const Imf::Header& header = file.header();
  ASSIGN_OR_RETURN(FilmImage image, shape_of(header));
  RETURN_IF_ERROR(check_sampling(header));
  const bool colour = has(header, kRgb);
  if (!colour && !has(header, kGrey))
    return invalid_input("no channels R G B among: {}", channel_names(header));

  const Imath::Box2i& window = header.dataWindow();
  Imf::FrameBuffer buffer;
  if (colour) {
    add_three(buffer, kRgb, image, image.rgb, window);
  } else {
    image.rgb.resize(3 * image.pixels());
    buffer.insert("Y", slice(image.rgb.data(), window, 3));
  }
  const bool variance = has(header, kVariance), standard_error = !variance && has(header, kStandardError);
  if (variance || standard_error)
    add_three(buffer, variance ? kVariance : kStandardError, image, image.variance, window);
  const auto present = [&](const char* name) { return header.channels().findChannel(name) != nullptr; };
  if (present("samples")) add_one(buffer, "samples", image, image.samples, window);
  if (present("cost")) add_one(buffer, "cost", image, image.cost, window);

  file.setFrameBuffer(buffer);
  file.readPixels(window.min.y, window.max.y);
  if (standard_error)
    for (float& v : image.variance) v *= v;
  if (!colour)
    for (size_t p = 0; p < image.pixels(); ++p)
      image.rgb[3 * p + 1] = image.rgb[3 * p + 2] = image.rgb[3 * p];
  return image;
}

}  // namespace

namespace {

void write_parts(MemoryStream& stream, const FilmImage& image, const ExrHeader& from,
                 std::span<const FilmImage> bins) {
  std::vector<Imf::Header> headers = {make_header(image, from)};
  std::vector<Imf::FrameBuffer> buffers = {make_buffer(image, headers[0].dataWindow())};
  if (!bins.empty()) headers[0].setName("picture");
  for (size_t b = 0; b < bins.size(); ++b) {
    headers.push_back(make_bin_header(bins[b], *from.transient, static_cast<int>(b)));
    buffers.push_back(make_buffer(bins[b], headers.back().dataWindow()));
  }
  for (size_t p = 0; p < headers.size(); ++p) {
    for (auto s = buffers[p].begin(); s != buffers[p].end(); ++s)
      headers[p].channels().insert(s.name(), Imf::Channel(Imf::FLOAT));
    if (headers.size() > 1) headers[p].setType(Imf::SCANLINEIMAGE);
  }
  if (bins.empty()) {
    Imf::OutputFile file(stream, headers[0]);
    file.setFrameBuffer(buffers[0]);
    file.writePixels(image.window.height());
    return;
  }
  Imf::MultiPartOutputFile file(stream, headers.data(), static_cast<int>(headers.size()));
  for (size_t p = 0; p < headers.size(); ++p) {
    Imf::OutputPart part(file, static_cast<int>(p));
    part.setFrameBuffer(buffers[p]);
    part.writePixels(image.window.height());
  }
}

absl::Status check_exists(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error))
    return make_status(absl::StatusCode::kNotFound, "{}: no such file", path);
  return absl::OkStatus();
}

/// May throw what OpenEXR throws.
absl::StatusOr<ExrBins> read_bins(const std::string& path) {
  Imf::MultiPartInputFile file(path.c_str());
  ExrBins out;
  for (int p = 0; p < file.parts(); ++p) {
    const Imf::Header& header = file.header(p);
    const auto* t0 = header.findTypedAttribute<Imf::DoubleAttribute>("penumbra:t0");
    const auto* t1 = header.findTypedAttribute<Imf::DoubleAttribute>("penumbra:t1");
    if (t0 == nullptr || t1 == nullptr || !header.hasName() || !header.name().starts_with("bin.")) continue;
    if (out.images.empty()) out.transient.t0 = t0->value();
    out.transient.t1 = t1->value();
    Imf::InputPart part(file, p);
    ASSIGN_OR_RETURN(FilmImage image, read_part(part));
    out.images.push_back(std::move(image));
  }
  if (out.images.empty()) return invalid_input("no bins of path length");
  out.transient.bins = static_cast<int>(out.images.size());
  return out;
}

}  // namespace

absl::Status write_exr(const std::string& path, const FilmImage& image, const ExrHeader& from,
                       std::span<const FilmImage> bins) {
  PENUMBRA_CHECK(image.rgb.size() == 3 * image.pixels());
  PENUMBRA_CHECK(bins.empty() ||
                 (from.transient && bins.size() == static_cast<size_t>(from.transient->bins)));
  MemoryStream stream;
  try {
    write_parts(stream, image, from, bins);
  } catch (const std::exception& fault) {
    return make_status(absl::StatusCode::kInternal, "{}: {}", path, fault.what());
  }
  return write_file_atomically(path, stream.bytes());
}

absl::StatusOr<ExrBins> read_exr_bins(const std::string& path) {
  RETURN_IF_ERROR(check_exists(path));
  try {
    absl::StatusOr<ExrBins> bins = read_bins(path);
    if (!bins.ok()) return invalid_input("{}: {}", path, message_of(bins.status()));
    return bins;
  } catch (const std::exception& fault) {
    return invalid_input("{}: not a readable EXR image: {}", path, fault.what());
  }
}

absl::StatusOr<FilmImage> read_exr(const std::string& path) {
  RETURN_IF_ERROR(check_exists(path));
  try {
    Imf::InputFile file(path.c_str());
    absl::StatusOr<FilmImage> image = read_part(file);
    if (!image.ok()) return invalid_input("{}: {}", path, message_of(image.status()));
    return image;
  } catch (const std::exception& fault) {  // OpenEXR's messages repeat the path
    return invalid_input("{}: not a readable EXR image: {}", path, fault.what());
  }
}

}  // namespace penumbra
