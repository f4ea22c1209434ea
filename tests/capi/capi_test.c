/* SPDX-License-Identifier: Apache-2.0 */
/* palpate.h from C: every function, with what it refuses. */
#include <math.h>
#include <palpate.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CHECK(condition)                                              \
  do {                                                                \
    if (!(condition)) {                                               \
      fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition); \
      exit(1);                                                        \
    }                                                                 \
  } while (0)

static double length(const double v[3]) {
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Straight above the crown: the head reaches 110 mm up, bumps of 1.5 mm at most. */
static palpate_place crown(const palpate_head* head) {
  const double above[3] = {0, 150, 0};
  palpate_place place;
  CHECK(palpate_head_nearest(head, above, &place) == PALPATE_OK);
  return place;
}

static palpate_tick_input at_depth(const palpate_place* place, double radius, double depth) {
  palpate_tick_input input = {.dt = 0.001};
  for (int k = 0; k < 3; ++k)
    input.position[k] = place->point[k] + (radius - depth) * place->normal[k];
  return input;
}

static void test_versions(void) {
  CHECK(palpate_abi() == PALPATE_ABI);
  CHECK(strchr(palpate_version(), '.') != NULL);
}

static void test_what_is_refused(const char* path) {
  palpate_head* head = (palpate_head*)1;
  palpate_error error;
  CHECK(palpate_head_load("/nowhere/head.glb", 0, &head, &error) == PALPATE_NO_FILE);
  CHECK(head == NULL && error.status == PALPATE_NO_FILE);
  CHECK(strstr(error.text, "/nowhere/head.glb") != NULL);
  CHECK(strchr(error.text, '\n') == NULL);
  CHECK(palpate_head_parse("glTF", 4, 0, &head, &error) == PALPATE_BAD_INPUT);
  CHECK(head == NULL && error.text[0] != '\0');
  CHECK(palpate_head_load(path, -1, &head, NULL) == PALPATE_BAD_INPUT);
  CHECK(palpate_head_load(NULL, 0, &head, &error) == PALPATE_BAD_ARGUMENT);
  CHECK(palpate_head_load(path, 0, NULL, &error) == PALPATE_BAD_ARGUMENT);
  palpate_head_free(NULL);
  palpate_touch_free(NULL);
}

static void test_parse_is_load(const char* path, const palpate_head* loaded) {
  FILE* file = fopen(path, "rb");
  CHECK(file != NULL);
  char* bytes = malloc(10000000);
  const size_t size = fread(bytes, 1, 10000000, file);
  fclose(file);
  palpate_head* parsed = NULL;
  CHECK(palpate_head_parse(bytes, size, 0, &parsed, NULL) == PALPATE_OK);
  palpate_error error;
  palpate_head* cut = NULL;
  CHECK(palpate_head_parse(bytes, size / 2, 0, &cut, &error) == PALPATE_BAD_INPUT && cut == NULL);
  free(bytes);
  palpate_head_facts a, b;
  CHECK(palpate_head_describe(parsed, &a) == PALPATE_OK);
  CHECK(palpate_head_describe(loaded, &b) == PALPATE_OK);
  CHECK(a.fingerprint == b.fingerprint && a.vertices == b.vertices);
  palpate_head_free(parsed);
}

static void test_facts_and_frames(const palpate_head* head) {
  palpate_head_facts facts;
  CHECK(palpate_head_describe(head, &facts) == PALPATE_OK);
  CHECK(facts.triangles == 8 * 16 * 16 && facts.vertices == 4 * 16 * 16 + 2);
  CHECK(facts.forces == 10 && facts.tool_radius == 5 && facts.map_radius == 5);
  CHECK(facts.unit_mm == 10);
  CHECK(fabs(facts.high[1] - 110) < 2 && fabs(facts.low[1] + 110) < 2);
  const double scan[3] = {1, -2 + 11, 3};
  double point[3], back[3];
  CHECK(palpate_head_from_scan(head, scan, point) == PALPATE_OK);
  CHECK(fabs(point[0]) < 1e-9 && fabs(point[1] - 110) < 1e-9 && fabs(point[2]) < 1e-9);
  CHECK(palpate_head_to_scan(head, point, back) == PALPATE_OK);
  for (int k = 0; k < 3; ++k) CHECK(fabs(back[k] - scan[k]) < 1e-12);
}

static void test_surface_and_curves(const palpate_head* head) {
  const palpate_place place = crown(head);
  CHECK(place.distance > 35 && place.distance < 45);
  CHECK(place.normal[1] > 0.9 && fabs(length(place.normal) - 1) < 1e-9);
  CHECK(fabs(place.weight[0] + place.weight[1] + place.weight[2] - 1) < 1e-9);
  CHECK(strcmp(palpate_region_name(place.region), "cranium") == 0);
  CHECK(palpate_region_name(-1) == NULL && palpate_region_name(99) == NULL);
  const double inside[3] = {0, 100, 0};
  palpate_place below;
  CHECK(palpate_head_nearest(head, inside, &below) == PALPATE_OK && below.distance < 0);
  const double nowhere[3] = {NAN, 0, 0};
  CHECK(palpate_head_nearest(head, nowhere, &below) == PALPATE_BAD_ARGUMENT);

  double force[10], travel[10];
  int32_t estimated = -1;
  CHECK(palpate_head_curve(head, place.vertex[0], force, travel, &estimated) == PALPATE_OK);
  CHECK(estimated == 0 && force[0] == 0.5 && force[9] == 5);
  for (int i = 1; i < 10; ++i) CHECK(travel[i] > travel[i - 1] && force[i] > force[i - 1]);
  CHECK(palpate_head_curve(head, 7, NULL, travel, &estimated) == PALPATE_OK && estimated == 1);
  CHECK(palpate_head_curve(head, 1u << 30, force, travel, NULL) == PALPATE_BAD_ARGUMENT);

  /* At a corner the blend is that vertex's curve. */
  palpate_place corner = place;
  corner.weight[0] = 1;
  corner.weight[1] = corner.weight[2] = 0;
  CHECK(palpate_head_curve(head, place.vertex[0], force, travel, NULL) == PALPATE_OK);
  double f = 0, k = 0;
  for (int i = 0; i < 10; ++i) {
    CHECK(palpate_head_press(head, &corner, travel[i], &f, &k) == PALPATE_OK);
    CHECK(fabs(f - force[i]) < 1e-9 && k > 0);
  }
  CHECK(palpate_head_press(head, &corner, -1, &f, NULL) == PALPATE_OK && f == 0);
  corner.vertex[1] = 1u << 30;
  CHECK(palpate_head_press(head, &corner, 1, &f, &k) == PALPATE_BAD_ARGUMENT);
}

static void test_options(const palpate_head* head) {
  palpate_touch_options options;
  palpate_touch* touch = NULL;
  palpate_error error;
  CHECK(palpate_touch_defaults("falcon", &options) == PALPATE_OK && options.peak_force == 8.0);
  CHECK(options.resolution == 0.0635);
  CHECK(palpate_touch_defaults("published", &options) == PALPATE_OK && options.peak_force == 8.7);
  CHECK(palpate_touch_defaults("teapot", &options) == PALPATE_BAD_ARGUMENT);
  CHECK(palpate_touch_defaults("3D Systems Touch", &options) == PALPATE_OK);
  CHECK(palpate_touch_new(head, &options, &touch, &error) == PALPATE_OK);
  CHECK(palpate_touch_scale(touch) < 1 && palpate_touch_warning(touch, 0) != NULL);
  palpate_touch_free(touch);
  options.slew = -1;
  CHECK(palpate_touch_new(head, &options, &touch, &error) == PALPATE_BAD_ARGUMENT);
  CHECK(touch == NULL && strstr(error.text, "slew") != NULL);
  memset(&options, 0, sizeof(options));
  CHECK(palpate_touch_new(head, &options, &touch, &error) == PALPATE_BAD_ARGUMENT);
  CHECK(strstr(error.text, "palpate_touch_defaults") != NULL);
}

static void test_tick(const palpate_head* head) {
  const palpate_place place = crown(head);
  palpate_touch_options options;
  CHECK(palpate_touch_defaults(NULL, &options) == PALPATE_OK);
  options.static_friction = options.kinetic_friction = options.viscous = options.rate = 0;
  options.passivity = 0;
  palpate_touch* touch = NULL;
  CHECK(palpate_touch_new(head, &options, &touch, NULL) == PALPATE_OK);
  palpate_tick_output output;
  palpate_tick_input input = {.dt = 0.001};
  for (double depth = -1; depth < 3; depth += 0.01) {
    input = at_depth(&place, 5, depth);
    CHECK(palpate_touch_tick(touch, &input, &output) == PALPATE_OK);
    CHECK(output.finite);
  }
  /* The published rule: depth is the radius less the distance to the nearest point. */
  palpate_place touched;
  CHECK(palpate_head_nearest(head, input.position, &touched) == PALPATE_OK);
  double force = 0;
  CHECK(palpate_head_press(head, &touched, 5 - touched.distance, &force, NULL) == PALPATE_OK);
  CHECK(output.in_contact && output.depth > 2.5 && force > 0.5);
  CHECK(fabs(output.depth - (5 - touched.distance)) < 1e-9);
  CHECK(fabs(output.map_force - force) < 1e-9 && fabs(length(output.force) - force) < 1e-9);
  CHECK(output.region == touched.region);
  input.position[0] = NAN;
  CHECK(palpate_touch_tick(touch, &input, &output) == PALPATE_OK);
  CHECK(!output.finite && length(output.force) == 0);
  palpate_touch_reset(touch);
  input = at_depth(&place, 5, -1);
  CHECK(palpate_touch_tick(touch, &input, &output) == PALPATE_OK);
  CHECK(!output.in_contact && output.vertex[0] == -1);
  CHECK(palpate_touch_tick(touch, NULL, &output) == PALPATE_BAD_ARGUMENT);
  CHECK(palpate_touch_removed(touch) == 0);
  palpate_touch_free(touch);
}

/* A touch outlives the handle of its head. */
static void test_any_order(const char* path) {
  palpate_head* head = NULL;
  palpate_touch* touch = NULL;
  CHECK(palpate_head_load(path, 0, &head, NULL) == PALPATE_OK);
  CHECK(palpate_touch_new(head, NULL, &touch, NULL) == PALPATE_OK);
  const palpate_place place = crown(head);
  palpate_head_free(head);
  palpate_tick_output output;
  for (double depth = -1; depth < 1; depth += 0.1) {
    const palpate_tick_input input = at_depth(&place, 5, depth);
    CHECK(palpate_touch_tick(touch, &input, &output) == PALPATE_OK);
  }
  CHECK(output.in_contact);
  palpate_touch_free(touch);
}

static void test_another_tool(const char* path) {
  palpate_head* head = NULL;
  CHECK(palpate_head_load(path, 3, &head, NULL) == PALPATE_OK);
  palpate_head_facts facts;
  CHECK(palpate_head_describe(head, &facts) == PALPATE_OK);
  CHECK(facts.tool_radius == 3 && facts.map_radius == 5);
  CHECK(strstr(palpate_head_warning(head, 0), "radius") != NULL);
  CHECK(palpate_head_warning(head, 1000) == NULL);
  palpate_head_free(head);
}

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  palpate_head* head = NULL;
  palpate_error error;
  if (palpate_head_load(argv[1], 0, &head, &error) != PALPATE_OK) {
    fprintf(stderr, "%s\n", error.text);
    return 1;
  }
  test_versions();
  test_what_is_refused(argv[1]);
  test_parse_is_load(argv[1], head);
  test_facts_and_frames(head);
  test_surface_and_curves(head);
  test_options(head);
  test_tick(head);
  test_any_order(argv[1]);
  test_another_tool(argv[1]);
  palpate_head_free(head);
  puts("palpate.h does as it says");
  return 0;
}
