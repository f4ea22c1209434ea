// SPDX-License-Identifier: GPL-3.0-or-later
// Uncompressed little-endian DICOM slices (PS3.5: implicit and explicit VR). Patient axes are left,
// posterior, superior: right-handed.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>

#include "image/voxels.hpp"

namespace palpate::image {
namespace {

constexpr std::size_t kPreamble = 128;
constexpr std::uint32_t kUndefined = 0xffffffff;
constexpr int kMostNested = 32;
constexpr double kEvenSpacing = 0.02;  // [-] by which the gaps between slices may differ
const std::string kRaw = "turn the slices into uncompressed ones: gdcmconv --raw IN OUT";

using Tag = std::uint32_t;  // group << 16 | element
constexpr Tag kTransferSyntax = 0x00020010, kSeries = 0x0020000e, kPosition = 0x00200032,
              kOrientation = 0x00200037, kSamples = 0x00280002, kRows = 0x00280010,
              kColumns = 0x00280011, kSpacing = 0x00280030, kAllocated = 0x00280100,
              kSigned = 0x00280103, kIntercept = 0x00281052, kSlope = 0x00281053,
              kPixels = 0x7fe00010, kItem = 0xfffee000, kItemEnd = 0xfffee00d,
              kSequenceEnd = 0xfffee0dd;

/// Walks the elements of one file. Every read is checked against the end.
class Walker {
 public:
  Walker(std::string_view bytes, std::size_t at, const std::string& name)
      : bytes_(bytes), at_(at), name_(name) {}

  struct Element {
    Tag tag = 0;
    std::string_view value;
    bool sequence = false;  ///< its items follow
    std::uint32_t length = 0;
  };
  [[nodiscard]] bool done() const { return at_ >= bytes_.size(); }
  [[nodiscard]] std::size_t at() const { return at_; }

  Element next(bool explicit_vr) {
    Element e;
    need(8);
    e.tag = static_cast<Tag>(load<std::uint16_t>(bytes_, at_)) << 16 |
            load<std::uint16_t>(bytes_, at_ + 2);
    std::string vr;
    const bool delimiter = e.tag >> 16 == 0xfffe;
    if (explicit_vr && !delimiter) {
      vr = std::string(bytes_.substr(at_ + 4, 2));
      static const std::string long_ones = "OB OW OF OD OL OV SQ UC UN UR UT SV UV";
      if (long_ones.find(vr) != long_ones.npos) {
        need(12);
        e.length = load<std::uint32_t>(bytes_, at_ + 8);
        at_ += 12;
      } else {
        e.length = load<std::uint16_t>(bytes_, at_ + 6);
        at_ += 8;
      }
    } else {
      e.length = load<std::uint32_t>(bytes_, at_ + 4);
      at_ += 8;
    }
    e.sequence = vr == "SQ" || (e.length == kUndefined && e.tag != kPixels) || e.tag == kItem;
    if (e.length == kUndefined) {
      if (e.tag == kPixels) refuse(name_, "its pixels are compressed", kRaw);
      return e;
    }
    if (e.sequence && delimiter) return e;
    need(e.length);
    e.value = bytes_.substr(at_, e.length);
    at_ += e.length;
    return e;
  }

  /// After a sequence or item of undefined length: leaves it behind.
  void skip_undefined(bool explicit_vr, int depth = 0) {
    if (depth > kMostNested) refuse(name_, "its sequences are nested too deep", "export it anew");
    while (!done()) {
      const Element e = next(explicit_vr);
      if (e.tag == kItemEnd || e.tag == kSequenceEnd) return;
      if (e.length == kUndefined) {
        skip_undefined(explicit_vr, depth + 1);
      } else if (e.tag == kItem) {
        need(e.length);
        at_ += e.length;
      }
    }
    refuse(name_, "ends inside a sequence", "copy the file again");
  }

 private:
  void need(std::size_t n) const {
    if (bytes_.size() < at_ || bytes_.size() - at_ < n)
      refuse(name_, fmt::format("ends at byte {} inside an element", bytes_.size()),
             "copy the file again");
  }
  std::string_view bytes_;
  std::size_t at_;
  const std::string& name_;
};

std::string text(std::string_view v) {
  while (!v.empty() && (v.back() == '\0' || v.back() == ' ')) v.remove_suffix(1);
  return std::string(v);
}

/// Decimal strings separated by backslashes; nothing where one is no finite number.
std::vector<double> decimals(std::string_view v, std::size_t n, const std::string& what,
                             const std::string& name) {
  std::vector<double> out;
  const std::string all = text(v);
  const char* at = all.c_str();
  while (out.size() < n) {
    char* end = nullptr;
    out.push_back(std::strtod(at, &end));
    if (end == at || !std::isfinite(out.back()))
      refuse(name, fmt::format("its {} is not {} numbers", what, n), "export the series anew");
    at = *end == '\\' ? end + 1 : end;
  }
  return out;
}

struct Slice {
  std::string name, series;
  int rows = 0, columns = 0;
  Vec3 position = Vec3::Zero(), along_row = Vec3::Zero(), along_column = Vec3::Zero();
  double slope = 1, intercept = 0;
  VoxelType type = VoxelType::i16;
  std::string_view pixels;
};

Slice read_slice(std::string_view bytes, const std::string& name) {
  std::map<Tag, std::string_view> found;
  Walker walk(bytes, kPreamble + 4, name);
  bool explicit_vr = true;  // the meta group always is
  std::string syntax = "1.2.840.10008.1.2";
  bool in_meta = true;
  while (!walk.done()) {
    if (in_meta && bytes.size() - walk.at() >= 2 && load<std::uint16_t>(bytes, walk.at()) != 2) {
      in_meta = false;
      if (syntax != "1.2.840.10008.1.2" && syntax != "1.2.840.10008.1.2.1")
        refuse(name, fmt::format("transfer syntax {} is not read", syntax.substr(0, 40)), kRaw);
      explicit_vr = syntax == "1.2.840.10008.1.2.1";
    }
    const Walker::Element e = walk.next(explicit_vr);
    if (e.length == kUndefined) {
      walk.skip_undefined(explicit_vr);
      continue;
    }
    if (e.tag == kTransferSyntax) syntax = text(e.value);
    found.try_emplace(e.tag, e.value);
    if (e.tag == kPixels) break;
  }
  const auto must = [&](Tag tag, const std::string& what) {
    const auto at = found.find(tag);
    if (at == found.end()) refuse(name, "has no " + what, "export the series anew");
    return at->second;
  };
  const auto number = [&](Tag tag, const std::string& what) {
    const std::string_view v = must(tag, what);
    if (v.size() < 2) refuse(name, "its " + what + " is empty", "export the series anew");
    return static_cast<int>(load<std::uint16_t>(v, 0));
  };
  Slice s;
  s.name = name;
  s.series = found.contains(kSeries) ? text(found[kSeries]) : "";
  s.rows = number(kRows, "number of rows");
  s.columns = number(kColumns, "number of columns");
  if (found.contains(kSamples) && number(kSamples, "samples per pixel") != 1)
    refuse(name, "is a colour picture", "give the original slices");
  const int bits = number(kAllocated, "bits per pixel");
  const bool is_signed = found.contains(kSigned) && number(kSigned, "sign") == 1;
  if (bits != 8 && bits != 16)
    refuse(name, fmt::format("{} bits per pixel are not read", bits), "export 16-bit slices");
  s.type = bits == 8 ? (is_signed ? VoxelType::i8 : VoxelType::u8)
                     : (is_signed ? VoxelType::i16 : VoxelType::u16);
  const auto p = decimals(must(kPosition, "position"), 3, "position", name);
  const auto o = decimals(must(kOrientation, "orientation"), 6, "orientation", name);
  const auto d = decimals(must(kSpacing, "pixel spacing"), 2, "pixel spacing", name);
  s.position = {p[0], p[1], p[2]};
  s.along_row = Vec3(o[0], o[1], o[2]) * d[1];  // the second number is between columns
  s.along_column = Vec3(o[3], o[4], o[5]) * d[0];
  if (found.contains(kSlope)) s.slope = decimals(found[kSlope], 1, "slope", name)[0];
  if (found.contains(kIntercept))
    s.intercept = decimals(found[kIntercept], 1, "intercept", name)[0];
  s.pixels = must(kPixels, "pixels");
  return s;
}

/// The series with the most slices, in the order of its normal.
std::vector<Slice> choose_series(std::vector<Slice> all, Volume& v, const std::string& name) {
  std::map<std::string, std::size_t> count;
  for (const Slice& s : all) ++count[s.series];
  const auto most = std::max_element(count.begin(), count.end(),
                                     [](auto& a, auto& b) { return a.second < b.second; });
  if (count.size() > 1)
    v.warnings.push_back(fmt::format("{} holds {} series; the one with {} slices was taken", name,
                                     count.size(), most->second));
  const std::string series = most->first;
  std::erase_if(all, [&](const Slice& s) { return s.series != series; });
  const Vec3 normal = all[0].along_row.cross(all[0].along_column).stableNormalized();
  std::stable_sort(all.begin(), all.end(), [&](const Slice& a, const Slice& b) {
    return normal.dot(a.position) < normal.dot(b.position);
  });
  return all;
}

void check_stack(const std::vector<Slice>& slices, const std::string& name) {
  const Slice& first = slices[0];
  const Vec3 normal = first.along_row.cross(first.along_column).stableNormalized();
  const double whole = normal.dot(slices.back().position - first.position);
  const double gap = whole / static_cast<double>(slices.size() - 1);
  for (std::size_t i = 0; i < slices.size(); ++i) {
    const Slice& s = slices[i];
    if (s.rows != first.rows || s.columns != first.columns ||
        (s.along_row - first.along_row).norm() > 1e-3 ||
        (s.along_column - first.along_column).norm() > 1e-3)
      refuse(s.name, "differs in size or direction from the first slice of its series",
             "give a folder with one straight series");
    if (i == 0) continue;
    const double here = normal.dot(s.position - slices[i - 1].position);
    if (!(std::abs(here - gap) <= kEvenSpacing * gap) || !(gap > 0))
      refuse(
          s.name,
          fmt::format("lies {:.3f} mm behind the slice before it, the others {:.3f} mm", here, gap),
          "a slice is missing or doubled: export the series anew to " + name);
  }
}

}  // namespace

Volume parse_dicom(const std::vector<std::pair<std::string, std::string>>& files,
                   const std::string& name) {
  std::vector<Slice> slices;
  for (const auto& [bytes, file] : files)
    if (bytes.size() > kPreamble + 4 && bytes.compare(kPreamble, 4, "DICM") == 0)
      slices.push_back(read_slice(bytes, file));
  if (slices.size() < 2)
    refuse(name, fmt::format("holds {} DICOM slices", slices.size()),
           "give the folder of a CT series, .nii or .nrrd");
  Volume v;
  v.format = "dicom";
  slices = choose_series(std::move(slices), v, name);
  if (slices.size() < 2)
    refuse(name, "holds no series of slices", "give the folder of a CT series");
  check_stack(slices, name);
  const Slice& first = slices[0];
  const std::size_t count =
      checked_count({first.columns, first.rows, static_cast<std::int64_t>(slices.size())}, name);
  v.size = {first.columns, first.rows, static_cast<int>(slices.size())};
  v.step.col(0) = first.along_row;
  v.step.col(1) = first.along_column;
  v.step.col(2) =
      (slices.back().position - first.position) / static_cast<double>(slices.size() - 1);
  v.origin = first.position;
  check_grid(v, name);
  v.value.reserve(count);
  const auto per_slice =
      static_cast<std::size_t>(first.rows) * static_cast<std::size_t>(first.columns);
  for (const Slice& s : slices) {
    const auto part = to_floats(s.pixels, s.type, false, per_slice, s.slope, s.intercept, s.name);
    v.value.insert(v.value.end(), part.begin(), part.end());
  }
  return v;
}

}  // namespace palpate::image
