// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <limits>
#include <map>

#include "core/error.hpp"
#include "image/filters.hpp"
#include "image/head_image.hpp"
#include "image/isosurface.hpp"
#include "phantom.hpp"

namespace palpate::image {
namespace {

/// Every directed edge has exactly one partner.
bool closed(const SurfaceMesh& mesh) {
  std::map<std::pair<int, int>, int> edges;
  for (const Triangle& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
  for (const auto& [e, n] : edges) {
    const auto back = edges.find({e.second, e.first});
    if (back == edges.end() || back->second != n) return false;
  }
  return true;
}

void expect_on(const SurfaceMesh& mesh, const Vec3& axes, double tolerance) {
  ASSERT_FALSE(mesh.empty());
  double most = 0;
  for (const Vec3& p : mesh.points) most = std::max(most, std::abs(level_of(p, axes)));
  EXPECT_LT(most, tolerance);
}

double volume_of(const Vec3& axes) {
  return 4.0 / 3 * 3.14159265358979 * axes.prod();
}

TEST(Isosurface, LiesOnASphereAndFacesOut) {
  Volume v;
  v.size = {48, 48, 48};
  v.origin = Vec3::Constant(-23.5);
  for (int k = 0; k < 48; ++k)
    for (int j = 0; j < 48; ++j)
      for (int i = 0; i < 48; ++i)
        v.value.push_back(static_cast<float>(20 - v.place(Vec3(i, j, k)).norm()));
  SurfaceMesh mesh = isosurface(v, 0);
  EXPECT_TRUE(closed(mesh));
  for (const Vec3& p : mesh.points) EXPECT_NEAR(p.norm(), 20, 0.1);
  EXPECT_NEAR(signed_volume(mesh), 4.0 / 3 * 3.14159265 * 8000, 200);
  v.step(0, 0) = -1;  // a mirrored grid still gives a surface that faces out
  v.origin[0] = 23.5;
  EXPECT_GT(signed_volume(isosurface(v, 0)), 0);
}

TEST(HeadOfCt, FindsSkinAndSkullOfAPhantom) {
  const HeadImage head = head_of_ct(phantom());
  expect_on(head.skin, kSkinAxes, 1.0);
  EXPECT_TRUE(closed(head.skin));
  EXPECT_TRUE(closed(head.skull));
  EXPECT_NEAR(signed_volume(head.skin) / volume_of(kSkinAxes), 1, 0.03);
  // The inside of the shell is a hollow: filled.
  EXPECT_NEAR(signed_volume(head.skull) / volume_of(kSkullAxes), 1, 0.05);
  for (const Vec3& p : head.skull.points) EXPECT_LT(std::abs(level_of(p, kSkullAxes)), 1.5);
  EXPECT_EQ(head.notes.size(), 2u);
}

TEST(HeadOfCt, RefusesThresholdsThatFindNothing) {
  ImageOptions options;
  options.bone_threshold = 3000;
  EXPECT_THROW((void)head_of_ct(phantom(4), options), InputError);
  options.bone_threshold = -500;
  EXPECT_THROW((void)head_of_ct(phantom(4), options), InputError);
}

TEST(HeadOfLabels, TakesBoneLabelsOnly) {
  Volume labels = phantom();
  for (int k = 0; k < labels.size[2]; ++k)
    for (int j = 0; j < labels.size[1]; ++j)
      for (int i = 0; i < labels.size[0]; ++i) {
        const Vec3 p = labels.place(Vec3(i, j, k));
        const bool shell =
            level_of(p, kSkullAxes) < 0 && level_of(p, kSkullAxes - Vec3::Constant(6)) > 0;
        labels.value[labels.index(i, j, k)] = level_of(p, kSkinAxes) > 0 ? 0
                                              : shell                    ? (p.x() > 0 ? 7 : 8)
                                                                         : 5;
      }
  const HeadImage head = head_of_labels(labels);
  expect_on(head.skin, kSkinAxes, 1.5);
  EXPECT_NEAR(signed_volume(head.skull) / volume_of(kSkullAxes), 1, 0.05);
}

TEST(ReadVolume, ThreeFormatsHoldTheSameVolume) {
  const Volume v = phantom(8);
  const Volume nifti = parse_nifti(nifti_of(v), "a.nii");
  const Volume nrrd = parse_nrrd(nrrd_of(v), "a.nrrd", {});
  std::vector<std::pair<std::string, std::string>> files;
  for (int k = v.size[2] - 1; k >= 0; --k) files.emplace_back(dicom_of(v, k), std::to_string(k));
  files.emplace_back("no slice", "notes.txt");
  const Volume dicom = parse_dicom(files, "folder");
  for (const Volume* read : {&nifti, &nrrd, &dicom}) {
    ASSERT_EQ(read->size, v.size) << read->format;
    EXPECT_TRUE(read->step.isApprox(v.step, 1e-4)) << read->format;
    EXPECT_TRUE(read->origin.isApprox(v.origin, 1e-4)) << read->format;
    for (std::size_t i = 0; i < v.value.size(); ++i)
      ASSERT_NEAR(read->value[i], v.value[i], 0.51) << read->format;
    EXPECT_TRUE(read->warnings.empty());
  }
}

TEST(ReadVolume, IsRefusedWhereverItIsCut) {
  const Volume v = phantom(16);
  const std::string nifti = nifti_of(v), nrrd = nrrd_of(v), first = dicom_of(v, 0);
  const std::string second = dicom_of(v, 1);
  for (std::size_t n = 0; n < nifti.size(); n += n < 400 ? 1 : 997)
    EXPECT_THROW((void)parse_nifti(nifti.substr(0, n), "cut"), InputError) << n;
  for (std::size_t n = 0; n < nrrd.size(); n += n < 400 ? 1 : 997)
    EXPECT_THROW((void)parse_nrrd(nrrd.substr(0, n), "cut", {}), InputError) << n;
  for (std::size_t n = 0; n < first.size(); ++n)
    EXPECT_THROW((void)parse_dicom({{first.substr(0, n), "cut"}, {second, "2"}}, "cut"), InputError)
        << n;
}

TEST(ReadVolume, RefusesHugeAndSenselessHeaders) {
  const Volume v = phantom(16);
  std::string nifti = nifti_of(v);
  for (int a = 0; a < 3; ++a) put<std::int16_t>(nifti, 42 + 2 * a, 32767);
  EXPECT_THROW((void)parse_nifti(nifti, "huge"), InputError);
  nifti = nifti_of(v);
  put<std::int16_t>(nifti, 42, -3);
  EXPECT_THROW((void)parse_nifti(nifti, "negative"), InputError);
  nifti = nifti_of(v);
  put<float>(nifti, 280, std::numeric_limits<float>::quiet_NaN());
  EXPECT_THROW((void)parse_nifti(nifti, "nan axis"), InputError);
  nifti = nifti_of(v);
  put<float>(nifti, 112, std::numeric_limits<float>::infinity());
  EXPECT_THROW((void)parse_nifti(nifti, "infinite slope"), InputError);
  for (const char* sizes : {"1e99 2 2", "99999 99999 99999", "-4 4 4", "a b c", "2 2"}) {
    const std::string header = std::string("NRRD0004\ntype: short\ndimension: 3\nsizes: ") + sizes +
                               "\nspacings: 1 1 1\nencoding: raw\n\n";
    EXPECT_THROW((void)parse_nrrd(header, sizes, {}), InputError) << sizes;
  }
  EXPECT_THROW((void)parse_dicom({}, "empty"), InputError);
  EXPECT_THROW((void)parse_dicom(
                   {{dicom_of(v, 0), "0"}, {dicom_of(v, 1), "1"}, {dicom_of(v, 3), "3"}}, "gap"),
               InputError);
}

}  // namespace
}  // namespace palpate::image
