// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstring>

#include "capi/handles.hpp"
#include "core/atomic_file.hpp"
#include "io/head_file.hpp"

using namespace palpate;
using namespace palpate::haptics;
using capi::guarded;
using capi::put;
using capi::report;

namespace palpate::capi {

palpate_status report(palpate_status status, std::string_view text, palpate_error* error) noexcept {
  if (!error) return status;
  error->status = status;
  const std::size_t n = std::min(text.size(), sizeof(error->text) - 1);
  std::memcpy(error->text, text.data(), n);
  error->text[n] = '\0';
  return status;
}

}  // namespace palpate::capi

namespace {

palpate_status make_head(std::string_view bytes, const std::string& name, double tool_radius,
                         palpate_head** head, palpate_error* error) noexcept {
  return guarded(error, [&] {
    TouchModelOptions options;
    options.tool_radius = tool_radius;
    auto made = std::make_unique<palpate_head>();
    made->model =
        std::make_shared<const TouchModel>(make_touch_model(io::parse_head(bytes, name), options));
    *head = made.release();
  });
}

// The point of the mesh that a scan's vertex became; -1 where the vertex has none.
std::int32_t row_of(const TouchModel& model, std::uint64_t vertex) {
  return vertex < model.mesh.vertex_of.size()
             ? model.mesh.vertex_of[static_cast<std::size_t>(vertex)]
             : -1;
}

}  // namespace

extern "C" {

const char* palpate_version(void) {
  return PALPATE_VERSION;
}
uint32_t palpate_abi(void) {
  return PALPATE_ABI;
}

palpate_status palpate_head_load(const char* path, double tool_radius, palpate_head** head,
                                 palpate_error* error) {
  if (head) *head = nullptr;
  if (!path || !head) return report(PALPATE_BAD_ARGUMENT, "path or head is null", error);
  std::string bytes;
  const palpate_status read = guarded(error, [&] { bytes = read_file(path); });
  if (read == PALPATE_BAD_INPUT) {
    if (error) error->status = PALPATE_NO_FILE;
    return PALPATE_NO_FILE;
  }
  return read == PALPATE_OK ? make_head(bytes, path, tool_radius, head, error) : read;
}

palpate_status palpate_head_parse(const void* bytes, size_t size, double tool_radius,
                                  palpate_head** head, palpate_error* error) {
  if (head) *head = nullptr;
  if (!bytes || !head) return report(PALPATE_BAD_ARGUMENT, "bytes or head is null", error);
  return make_head({static_cast<const char*>(bytes), size}, "head", tool_radius, head, error);
}

void palpate_head_free(palpate_head* head) {
  delete head;
}

palpate_status palpate_head_describe(const palpate_head* head, palpate_head_facts* facts) {
  if (!head || !facts) return PALPATE_BAD_ARGUMENT;
  const TouchModel& m = *head->model;
  facts->vertices = m.mesh.vertex_of.size();
  facts->triangles = m.mesh.triangles.size();
  facts->fingerprint = m.fingerprint;
  facts->forces = static_cast<uint32_t>(m.curves.knots);
  facts->tool_radius = m.tool_radius;
  facts->map_radius = m.map_radius;
  facts->unit_mm = m.unit_mm;
  const Box box = m.mesh.tree.box();
  put(box.low, facts->low);
  put(box.high, facts->high);
  return PALPATE_OK;
}

const char* palpate_head_warning(const palpate_head* head, uint32_t index) {
  return head && index < head->model->warnings.size() ? head->model->warnings[index].c_str()
                                                      : nullptr;
}

palpate_status palpate_head_from_scan(const palpate_head* head, const double scan[3],
                                      double point[3]) {
  if (!head || !scan || !point) return PALPATE_BAD_ARGUMENT;
  put(head->model->frame.to_head(head->model->unit_mm * capi::vector(scan)), point);
  return PALPATE_OK;
}

palpate_status palpate_head_to_scan(const palpate_head* head, const double point[3],
                                    double scan[3]) {
  if (!head || !scan || !point) return PALPATE_BAD_ARGUMENT;
  put(head->model->frame.to_scan(capi::vector(point)) / head->model->unit_mm, scan);
  return PALPATE_OK;
}

palpate_status palpate_head_curve(const palpate_head* head, uint64_t vertex, double* force,
                                  double* travel, int32_t* estimated) {
  if (!head) return PALPATE_BAD_ARGUMENT;
  const TouchModel& m = *head->model;
  const std::int32_t row = row_of(m, vertex);
  if (row < 0) return PALPATE_BAD_ARGUMENT;
  if (force) std::copy(m.curves.force.begin(), m.curves.force.end(), force);
  const double* u = m.curves.travel.data() + static_cast<std::size_t>(row) * m.curves.knots;
  if (travel) std::copy_n(u, m.curves.knots, travel);
  if (estimated) *estimated = m.estimated[static_cast<std::size_t>(row)];
  return PALPATE_OK;
}

palpate_status palpate_head_nearest(const palpate_head* head, const double position[3],
                                    palpate_place* place) {
  if (!head || !position || !place) return PALPATE_BAD_ARGUMENT;
  const TouchModel& m = *head->model;
  const Vec3 p = capi::vector(position);
  if (!p.allFinite()) return PALPATE_BAD_ARGUMENT;
  const SurfacePoint at = m.mesh.nearest(p, std::numeric_limits<double>::infinity());
  if (!at.found()) return PALPATE_BAD_ARGUMENT;  // a distance that overflows
  put(at.on.point, place->point);
  put(m.mesh.blended_normal(at), place->normal);
  const bool outside = m.mesh.side_normal(at).dot(p - at.on.point) >= 0;
  place->distance = outside ? std::sqrt(at.distance2) : -std::sqrt(at.distance2);
  put(at.on.barycentric, place->weight);
  place->region = static_cast<int32_t>(m.region_at(at));
  place->estimated = 0;
  const Triangle& corners = m.mesh.triangles[static_cast<std::size_t>(at.triangle)];
  for (int k = 0; k < 3; ++k) {
    const auto corner = static_cast<std::size_t>(corners[k]);
    place->vertex[k] = static_cast<uint64_t>(m.mesh.source_vertex[corner]);
    if (m.estimated[corner]) place->estimated = 1;
  }
  return PALPATE_OK;
}

palpate_status palpate_head_press(const palpate_head* head, const palpate_place* place,
                                  double depth, double* force, double* stiffness) {
  if (!head || !place || std::isnan(depth)) return PALPATE_BAD_ARGUMENT;
  const TouchModel& m = *head->model;
  Triangle corners;
  for (int k = 0; k < 3; ++k) {
    corners[k] = row_of(m, place->vertex[k]);
    if (corners[k] < 0 || !std::isfinite(place->weight[k])) return PALPATE_BAD_ARGUMENT;
  }
  const CurveValue value = m.curves.blend_force(corners, capi::vector(place->weight), depth);
  if (force) *force = value.force;
  if (stiffness) *stiffness = value.stiffness;
  return PALPATE_OK;
}

const char* palpate_region_name(int32_t region) {
  const auto index = static_cast<std::size_t>(region);
  return region >= 0 && index < kSkinRegionNames.size() ? kSkinRegionNames[index].data() : nullptr;
}

}  // extern "C"
