/* SPDX-License-Identifier: Apache-2.0 */
/* A haptic loop on libpalpate in C: a tool goes up and down on the face at 1 kHz, and the force is
 * printed ten times a second. Put your device's calls where the comments say.
 *   cc touch_loop.c $(pkg-config --cflags --libs palpate) -lm -o touch_loop
 *   touch_loop head.glb [seconds [device]]
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <palpate.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

/* The place of the skin that the tool presses: the foremost, which is the face's. */
static int front_of(const palpate_head* head, palpate_place* place) {
  palpate_head_facts facts;
  if (palpate_head_describe(head, &facts) != PALPATE_OK) return 0;
  const double before[3] = {0.5 * (facts.low[0] + facts.high[0]),
                            0.5 * (facts.low[1] + facts.high[1]), facts.high[2] + 200};
  return palpate_head_nearest(head, before, place) == PALPATE_OK;
}

/* In place of a device: 4 mm above the skin to 3 mm below it, once in two seconds. */
static void scripted_position(const palpate_place* place, double tool_radius, double seconds,
                              double position[3]) {
  const double height = 0.5 + 3.5 * cos(3.14159265358979 * seconds);
  for (int k = 0; k < 3; ++k)
    position[k] = place->point[k] + (tool_radius + height) * place->normal[k];
}

static void sleep_until(struct timespec* deadline) {
  const long period = 1000000; /* [ns] */
  deadline->tv_nsec += period;
  if (deadline->tv_nsec >= 1000000000) {
    deadline->tv_nsec -= 1000000000;
    ++deadline->tv_sec;
  }
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, deadline, NULL);
}

static void loop(palpate_touch* touch, const palpate_place* place, double tool_radius,
                 int seconds) {
  struct timespec deadline;
  clock_gettime(CLOCK_MONOTONIC, &deadline);
  palpate_tick_input input = {.dt = 0.001};
  palpate_tick_output output;
  for (int i = 0; i < 1000 * seconds; ++i) {
    sleep_until(&deadline);
    /* Here: read the device; turn its axes and millimetres into the head's frame. */
    scripted_position(place, tool_radius, 0.001 * i, input.position);
    palpate_touch_tick(touch, &input, &output);
    /* Here: turn output.force back into the device's axes and send it. */
    if (i % 100 == 0)
      printf("%5.1f s  depth %5.2f mm  force %5.2f N  %s\n", 0.001 * i, output.depth,
             sqrt(output.force[0] * output.force[0] + output.force[1] * output.force[1] +
                  output.force[2] * output.force[2]),
             output.in_contact ? palpate_region_name(output.region) : "free space");
  }
}

int main(int argc, char** argv) {
  if (argc < 2) {
    fprintf(stderr, "usage: touch_loop head.glb [seconds [device]]\n");
    return 2;
  }
  palpate_error error;
  palpate_head* head = NULL;
  palpate_touch* touch = NULL;
  palpate_touch_options options;
  palpate_head_facts facts;
  palpate_place place;
  int exit_code = 2;

  if (palpate_touch_defaults(argc > 3 ? argv[3] : "falcon", &options) != PALPATE_OK) {
    fprintf(stderr, "there is no device '%s'\n", argv[3]);
    return exit_code;
  }
  if (palpate_head_load(argv[1], 0, &head, &error) != PALPATE_OK ||
      palpate_touch_new(head, &options, &touch, &error) != PALPATE_OK) {
    fprintf(stderr, "%s\n", error.text);
  } else if (palpate_head_describe(head, &facts) == PALPATE_OK && front_of(head, &place)) {
    for (uint32_t i = 0; palpate_touch_warning(touch, i); ++i)
      printf("note: %s\n", palpate_touch_warning(touch, i));
    loop(touch, &place, facts.tool_radius, argc > 2 ? atoi(argv[2]) : 4);
    exit_code = 0;
  }
  palpate_touch_free(touch);
  palpate_head_free(head);
  return exit_code;
}
