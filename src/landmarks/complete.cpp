// SPDX-License-Identifier: GPL-3.0-or-later
// The pose and shape of the statistical face on the scan and on the whole head give a map between
// them: similarity, and the difference of their shapes, which carries what a face tells about its
// vault (16 modes of 500 heads). Then passes of closest points (Besl & McKay 1992), coarse to fine:
// each point of the head moves by the Gaussian-weighted mean of what its surroundings lack to the
// scan. A constant in the denominator makes that fade where there is no scan.
#include "landmarks/complete.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/error.hpp"
#include "landmarks/pose.hpp"
#include "landmarks/verify.hpp"
#include "surface/join.hpp"
#include "surface/repair.hpp"

namespace palpate::landmarks {
namespace {

constexpr double kCapArea = 1500;   // [mm^2] of a filled patch that is the end of the scan
constexpr double kShapeReach = 25;  // [mm] about the distance of the model's points on the vault
constexpr double kHold = 0.012;     // [1/mm^2] pull to no motion: a fiftieth of a dense scan's pull
constexpr double kBehind = 12;      // [mm] scan this far inside the bent head is its own back sheet
constexpr double kBeyond = 40;      // [mm] scan this far off is no head: shoulders, hair, a chair
constexpr double kCovers = 30;   // [mm] the scan stands for what lies this near, along its normal
constexpr double kOnRim = 0.05;  // [-] share of a triangle's inner corner

// [edges] Skin farther than this from the scan's rim, or from its inside, is not scanned: 99 % of
// scanned skin lies within a tenth.
constexpr double kOffRim = 0.1, kOffScan = 0.25;

/// [mm] width of the Gaussian, and how far the scan may lie.
struct Pass {
  double width, reach;
};
constexpr std::array<Pass, 5> kPasses = {Pass{40, 25}, Pass{25, 15}, Pass{15, 10}, Pass{8, 6},
                                         Pass{6, 5}};

std::vector<std::vector<std::int32_t>> triangles_of_points(const SurfaceMesh& mesh) {
  std::vector<std::vector<std::int32_t>> of(mesh.points.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::int32_t v : mesh.triangles[t]) of[v].push_back(static_cast<std::int32_t>(t));
  return of;
}

double area(const SurfaceMesh& mesh, const Triangle& t) {
  const Vec3& a = mesh.points[t[0]];
  return 0.5 * (mesh.points[t[1]] - a).cross(mesh.points[t[2]] - a).norm();
}

/// Patches of flagged triangles that hang together by points: per triangle the patch, -1 elsewhere.
struct Patches {
  std::vector<int> of;
  std::vector<double> area;  ///< [mm^2]
};
Patches patches(const SurfaceMesh& mesh, const std::vector<std::uint8_t>& flagged) {
  const auto around = triangles_of_points(mesh);
  Patches found{std::vector<int>(flagged.size(), -1), {}};
  for (std::size_t seed = 0; seed < flagged.size(); ++seed) {
    if (!flagged[seed] || found.of[seed] >= 0) continue;
    const int number = static_cast<int>(found.area.size());
    found.area.push_back(0);
    found.of[seed] = number;
    std::vector<std::int32_t> open = {static_cast<std::int32_t>(seed)};
    while (!open.empty()) {
      const Triangle& t = mesh.triangles[open.back()];
      open.pop_back();
      found.area[number] += area(mesh, t);
      for (const std::int32_t v : t)
        for (const std::int32_t next : around[v])
          if (flagged[next] && found.of[next] < 0) {
            found.of[next] = number;
            open.push_back(next);
          }
    }
  }
  return found;
}

/// The flagged triangles with the points that they use.
SurfaceMesh part(const SurfaceMesh& mesh, const std::vector<std::uint8_t>& keep) {
  SurfaceMesh out;
  std::vector<std::int32_t> number(mesh.points.size(), -1);
  for (std::size_t t = 0; t < keep.size(); ++t) {
    if (!keep[t]) continue;
    Triangle corners = mesh.triangles[t];
    for (std::int32_t& v : corners) {
      if (number[v] < 0) {
        number[v] = static_cast<std::int32_t>(out.points.size());
        out.points.push_back(mesh.points[v]);
      }
      v = number[v];
    }
    out.triangles.push_back(corners);
  }
  return out;
}

std::vector<std::uint8_t> filled_triangles(const SurfaceMesh& mesh,
                                           const std::vector<std::uint8_t>& filled) {
  std::vector<std::uint8_t> out;
  for (const auto& [a, b, c] : mesh.triangles) out.push_back(filled[a] && filled[b] && filled[c]);
  return out;
}

/// All triangles but those of caps and those that touch one: covers of eyes and mouth stay.
std::vector<std::uint8_t> without_caps(const SurfaceMesh& mesh,
                                       const std::vector<std::uint8_t>& closed) {
  const Patches found = patches(mesh, closed);
  std::vector<std::uint8_t> cap(mesh.points.size()), keep;
  for (std::size_t t = 0; t < closed.size(); ++t)
    if (closed[t] && found.area[found.of[t]] > kCapArea)
      for (const std::int32_t v : mesh.triangles[t]) cap[v] = 1;
  for (const auto& [a, b, c] : mesh.triangles) keep.push_back(!cap[a] && !cap[b] && !cap[c]);
  return keep;
}

/// An open surface that knows its border.
struct OpenSurface {
  SurfaceMesh mesh;
  std::vector<Vec3> normals;         // of its triangles
  std::vector<std::uint8_t> border;  // of its points
  surface::SurfaceQuery query;

  explicit OpenSurface(SurfaceMesh m)
      : mesh(std::move(m)),
        normals(triangle_normals(mesh)),
        border(mesh.points.size()),
        query(mesh) {
    std::set<std::pair<std::int32_t, std::int32_t>> edges;
    for (const Triangle& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) edges.insert({t[k], t[(k + 1) % 3]});
    for (const auto& [a, b] : edges)
      if (!edges.contains({b, a})) border[a] = border[b] = 1;
  }
  [[nodiscard]] bool on_rim(const surface::ClosestPoint& c) const {
    for (int k = 0; k < 3; ++k)
      if (c.barycentric[k] > kOnRim && !border[mesh.triangles[c.triangle][k]]) return false;
    return true;
  }
};

/// Where the detection has the statistical face.
FacePose pose_of(const Detection& found) {
  const FaceModel& model = face_model();
  const Vec3 left = model.marks.at("eye_outer_left"), right = model.marks.at("eye_outer_right");
  const Vec3 apart = found.landmarks.at("eye_outer_left").position -
                     found.landmarks.at("eye_outer_right").position;
  FacePose pose;
  pose.rotation = found.frame.rotation.transpose();
  pose.scale = apart.norm() / (left - right).norm();
  pose.translation = found.frame.origin - pose.scale * (pose.rotation * (0.5 * (left + right)));
  pose.shape[FaceModel::kOpening] = found.mouth_opening / FaceModel::kOpeningAngle;
  return pose;
}

/// The same on an open face: what it does not show has no say.
FacePose pose_on(const SurfaceMesh& open_face, FacePose pose, const Pins& pins) {
  const Skin skin(open_face);
  pose = fit_pose(skin, pose, {.iterations = 10, .tolerance_mm = 5, .reach_mm = 15}, pins);
  const double opening = pose.shape[FaceModel::kOpening];  // a mouth that is shut stays so
  pose.shape = {};
  pose.shape[FaceModel::kOpening] = opening;
  return fit_pose(skin, pose,
                  {.iterations = 20,
                   .with_shape = true,
                   .with_mouth = opening > 0,
                   .tolerance_mm = 2.5,
                   .reach_mm = 8},
                  pins);
}

/// Points of the whole head, carried from its pose and shape to the face's.
void carry(std::vector<Vec3>& points, const FacePose& from, const FacePose& to) {
  const FaceModel& model = face_model();
  std::vector<Vec3> here, change;
  for (std::size_t i = 0; i < model.points.size(); ++i) {
    here.push_back(model.point(i, from.shape));
    change.push_back(model.point(i, to.shape) - here.back());
  }
  for (Vec3& p : points) {
    const Vec3 m = from.rotation.transpose() * (p - from.translation) / from.scale;
    Vec3 sum = Vec3::Zero();
    double weights = 0;
    for (std::size_t i = 0; i < here.size(); ++i) {
      const double w = std::exp(-(m - here[i]).squaredNorm() / (2 * kShapeReach * kShapeReach));
      weights += w;
      sum += w * change[i];
    }
    p = to.to_scan(weights > 0 ? Vec3(m + sum / weights) : m);
  }
}

/// Which triangles of the head, carried near the face, have the scan beside them.
std::vector<std::uint8_t> beside(const SurfaceMesh& head, const OpenSurface& face) {
  const std::vector<Vec3> normal = vertex_normals(head);
  std::vector<std::uint8_t> near, out;
  for (std::size_t v = 0; v < normal.size(); ++v) {
    const surface::ClosestPoint c = face.query.closest(head.points[v], kPasses[0].reach);
    near.push_back(c.triangle >= 0 && !face.on_rim(c) &&
                   face.normals[c.triangle].dot(normal[v]) > 0.5);
  }
  for (const auto& [a, b, c] : head.triangles) out.push_back(near[a] && near[b] && near[c]);
  return out;
}

void bend(SurfaceMesh& head, const OpenSurface& face, const Pass& pass) {
  const std::vector<Vec3> normal = vertex_normals(head);
  std::vector<Vec3> places, lacks;
  for (std::size_t v = 0; v < normal.size(); ++v) {
    const surface::ClosestPoint c = face.query.closest(head.points[v], pass.reach);
    if (c.triangle < 0 || face.on_rim(c) || face.normals[c.triangle].dot(normal[v]) < 0.5) continue;
    places.push_back(head.points[v]);
    lacks.push_back(c.point - head.points[v]);
  }
  if (places.empty()) return;
  const surface::PointTree tree(places);
  std::vector<surface::PointTree::Neighbour> near;
  for (Vec3& p : head.points) {
    tree.within(p, 2.5 * pass.width, near);
    Vec3 sum = Vec3::Zero();
    double weights = kHold * pass.width * pass.width;
    for (const auto& n : near) {
      const double w = std::exp(-n.distance2 / (2 * pass.width * pass.width));
      weights += w;
      sum += w * lacks[n.point];
    }
    p += sum / weights;
  }
}

/// The scan's share of the head: not its own back sheet, shoulders or what else came along.
std::vector<std::uint8_t> of_head(const SurfaceMesh& face, std::vector<std::uint8_t> keep,
                                  const SurfaceMesh& head) {
  const surface::SurfaceQuery query(head);
  const std::vector<Vec3> own = triangle_normals(face), its = triangle_normals(head);
  for (std::size_t t = 0; t < keep.size(); ++t) {
    const auto& [a, b, c] = face.triangles[t];
    const Vec3 middle = (face.points[a] + face.points[b] + face.points[c]) / 3;
    const surface::ClosestPoint near = query.closest(middle);
    const double depth = (near.point - middle).dot(its[near.triangle]);
    const bool behind = depth > kBehind && own[t].dot(its[near.triangle]) < 0;
    if (behind || near.distance > kBeyond) keep[t] = 0;
  }
  const Patches found = patches(face, keep);
  const auto largest = std::max_element(found.area.begin(), found.area.end()) - found.area.begin();
  for (std::size_t t = 0; t < keep.size(); ++t) keep[t] = found.of[t] == largest;
  return keep;
}

/// The bent head's largest piece that the scan does not stand for.
SurfaceMesh beyond(const SurfaceMesh& head, const OpenSurface& face, double gap) {
  const std::vector<Vec3> normal = vertex_normals(head);
  std::vector<std::uint8_t> free(head.points.size()), keep;
  for (std::size_t v = 0; v < free.size(); ++v) {
    const surface::ClosestPoint c = face.query.closest(head.points[v]);
    const bool along = !face.on_rim(c) && face.normals[c.triangle].dot(normal[v]) > 0;
    free[v] = c.distance > (along ? kCovers : gap);
  }
  for (const auto& [a, b, c] : head.triangles) keep.push_back(free[a] && free[b] && free[c]);
  const Patches found = patches(head, keep);
  if (found.area.empty()) throw InputError("the scan has a back that does not look like a head's");
  const auto largest = std::max_element(found.area.begin(), found.area.end()) - found.area.begin();
  for (std::size_t t = 0; t < keep.size(); ++t) keep[t] = found.of[t] == largest;
  return part(head, keep);
}

/// The completed head is one piece beyond the scan's border. Specks within the face (between the
/// lids, where the new surface spans what the scan folds) are not of it: closed, not completed.
void keep_one_piece(CompletedFace& c) {
  std::vector<std::uint8_t> completed;  // triangles that touch it
  for (const Triangle& t : c.skin.triangles)
    completed.push_back(c.filled[t[0]] == 2 || c.filled[t[1]] == 2 || c.filled[t[2]] == 2);
  const Patches found = patches(c.skin, completed);
  if (found.area.empty()) return;
  const auto largest = std::max_element(found.area.begin(), found.area.end()) - found.area.begin();
  for (std::size_t t = 0; t < completed.size(); ++t)
    if (completed[t] && found.of[t] != largest)
      for (const std::int32_t v : c.skin.triangles[t])
        if (c.filled[v] == 2) c.filled[v] = 1;
}

double completed_share(const CompletedFace& c) {
  double all = 0, completed = 0;
  for (const Triangle& t : c.skin.triangles) {
    const double a = area(c.skin, t);
    all += a;
    for (const std::int32_t v : t) completed += c.filled[v] == 2 ? a / 3 : 0;
  }
  return completed / all;
}

}  // namespace

CompletedFace complete_face(const SurfaceMesh& face, const std::vector<std::uint8_t>& filled,
                            const Detection& found, const SurfaceMesh& whole_head, double edge,
                            const Progress& progress) {
  const std::vector<std::uint8_t> closed = filled_triangles(face, filled);
  std::vector<std::uint8_t> keep = without_caps(face, closed);
  Pins pins;
  for (const auto& [name, mark] : found.landmarks)
    if (mark.confidence == 1) pins[name] = mark.position;
  const FacePose pose = pose_on(part(face, keep), pose_of(found), pins);

  const SurfaceMesh whole =
      surface::make_working_surface(whole_head, {.target_edge = edge}, progress).mesh;
  const Skin skin(whole);
  const FaceSearch own = search_face(skin, {}, progress);
  std::vector<std::string> unused;
  verify_face(skin, own, {}, false, unused);
  SurfaceMesh head = whole;
  carry(head.points, own.pose, pose);
  // Once more by what both show: where the face leaves its head open, it does so for both.
  const auto shown = beside(head, OpenSurface(part(face, keep)));
  head.points = whole.points;
  carry(head.points, pose_on(part(whole, shown), own.pose, {}), pose);
  keep = of_head(face, keep, head);
  const OpenSurface open(part(face, keep));
  for (const Pass& pass : kPasses) bend(head, open, pass);

  const surface::JoinedSurface joined =
      surface::join_surfaces(open.mesh, beyond(head, open, edge), head, edge, progress);
  CompletedFace result;
  result.skin = joined.mesh;
  std::vector<std::uint8_t> cover;  // of the kept triangles
  for (std::size_t t = 0; t < keep.size(); ++t)
    if (keep[t]) cover.push_back(closed[t]);
  for (std::size_t v = 0; v < joined.nearest.size(); ++v) {
    const auto t = static_cast<std::size_t>(joined.nearest[v]);
    const surface::ClosestPoint c = open.query.closest(result.skin.points[v]);
    const double off = (open.on_rim(c) ? kOffRim : kOffScan) * edge;
    const bool completed = t >= cover.size() || (!cover[t] && c.distance > off);
    result.filled.push_back(completed ? 2 : cover[t]);
  }
  keep_one_piece(result);
  result.completed_share = completed_share(result);
  return result;
}

void drop_unseen(LandmarkSet& landmarks, const CompletedFace& head) {
  const surface::SurfaceQuery query(head.skin);
  std::erase_if(landmarks, [&](const auto& item) {
    const Triangle& t = head.skin.triangles[query.closest(item.second.position).triangle];
    return item.second.confidence < 1 && !always_answered(item.first) &&
           (head.filled[t[0]] == 2 || head.filled[t[1]] == 2 || head.filled[t[2]] == 2);
  });
}

}  // namespace palpate::landmarks
