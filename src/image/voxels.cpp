// SPDX-License-Identifier: GPL-3.0-or-later
#include "image/voxels.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/error.hpp"

namespace palpate::image {
namespace {

constexpr std::int64_t kMostAlong = 8192;
constexpr std::size_t kMostVoxels = std::size_t{1} << 30;

template <class T>
void convert(std::string_view bytes, bool swap, double slope, double intercept,
             std::vector<float>& out) {
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = static_cast<float>(static_cast<double>(load<T>(bytes, i * sizeof(T), swap)) * slope +
                                intercept);
}

}  // namespace

std::size_t bytes_of(VoxelType type) {
  switch (type) {
    case VoxelType::i8:
    case VoxelType::u8:
      return 1;
    case VoxelType::i16:
    case VoxelType::u16:
      return 2;
    case VoxelType::f64:
      return 8;
    default:
      return 4;
  }
}

void refuse(const std::string& name, const std::string& what, const std::string& remedy) {
  throw InputError(fmt::format("{}: {}; {}", name, what, remedy));
}

std::size_t checked_count(const std::array<std::int64_t, 3>& size, const std::string& name) {
  std::size_t count = 1;
  for (const std::int64_t n : size) {
    if (n < 2 || n > kMostAlong)
      refuse(name,
             fmt::format("{} x {} x {} voxels are no volume of a head", size[0], size[1], size[2]),
             "give a three-dimensional volume of 2 to 8192 voxels along each axis");
    count *= static_cast<std::size_t>(n);
  }
  if (count > kMostVoxels)
    refuse(name, fmt::format("{} voxels are more than {}", count, kMostVoxels),
           "resample the volume to a coarser grid");
  return count;
}

std::vector<float> to_floats(std::string_view bytes, VoxelType type, bool swap, std::size_t count,
                             double slope, double intercept, const std::string& name) {
  if (bytes.size() / bytes_of(type) < count)
    refuse(name,
           fmt::format("holds {} of {} bytes of voxels", bytes.size(), count * bytes_of(type)),
           "the file is cut short: copy it again");
  if (!std::isfinite(slope) || !std::isfinite(intercept))
    refuse(name, "its scaling is not finite", "write the volume anew");
  std::vector<float> out(count);
  switch (type) {
    case VoxelType::i8:
      convert<std::int8_t>(bytes, swap, slope, intercept, out);
      break;
    case VoxelType::u8:
      convert<std::uint8_t>(bytes, swap, slope, intercept, out);
      break;
    case VoxelType::i16:
      convert<std::int16_t>(bytes, swap, slope, intercept, out);
      break;
    case VoxelType::u16:
      convert<std::uint16_t>(bytes, swap, slope, intercept, out);
      break;
    case VoxelType::i32:
      convert<std::int32_t>(bytes, swap, slope, intercept, out);
      break;
    case VoxelType::u32:
      convert<std::uint32_t>(bytes, swap, slope, intercept, out);
      break;
    case VoxelType::f32:
      convert<float>(bytes, swap, slope, intercept, out);
      break;
    case VoxelType::f64:
      convert<double>(bytes, swap, slope, intercept, out);
      break;
  }
  for (std::size_t i = 0; i < count; ++i)
    if (!std::isfinite(out[i]))
      refuse(name, fmt::format("voxel {} is not a finite number", i),
             "replace such voxels by the value of air");
  return out;
}

std::string inflate_gzip(std::string_view bytes, std::size_t most, const std::string& name) {
  z_stream stream{};
  constexpr int kGzip = 15 + 16;  // largest window, gzip wrapper
  if (inflateInit2(&stream, kGzip) != Z_OK) refuse(name, "zlib does not start", "close programs");
  const std::unique_ptr<z_stream, int (*)(z_stream*)> guard(&stream, inflateEnd);
  std::string out;
  constexpr std::size_t kChunk = std::size_t{1} << 20;
  std::size_t taken = 0;
  int state = Z_OK;
  while (state != Z_STREAM_END && out.size() < most) {
    if (stream.avail_in == 0) {
      const std::size_t more = std::min(kChunk, bytes.size() - taken);
      if (more == 0) break;
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + taken));
      stream.avail_in = static_cast<uInt>(more);
      taken += more;
    }
    const std::size_t room = std::min(kChunk, most - out.size());
    const std::size_t before = out.size();
    out.resize(before + room);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + before);
    stream.avail_out = static_cast<uInt>(room);
    state = inflate(&stream, Z_NO_FLUSH);
    out.resize(before + room - stream.avail_out);
    if (state != Z_OK && state != Z_STREAM_END && state != Z_BUF_ERROR)
      refuse(name, "its compressed data are damaged", "copy the file again");
  }
  return out;
}

void check_grid(const Volume& v, const std::string& name) {
  for (int a = 0; a < 3; ++a) {
    const double edge = v.spacing(a);
    if (!(edge >= 0.02 && edge <= 20))
      refuse(name, fmt::format("a voxel of {} mm along axis {}", edge, a + 1),
             "the header must say the voxels' size: 0.02 to 20 mm");
  }
  const double volume = v.step.determinant();
  const double full = v.spacing(0) * v.spacing(1) * v.spacing(2);
  if (!(std::abs(volume) > 0.1 * full) || !v.origin.allFinite())
    refuse(name, "its axes do not span space", "the header must hold three independent directions");
}

}  // namespace palpate::image
