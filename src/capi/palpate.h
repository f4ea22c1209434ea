/* SPDX-License-Identifier: Apache-2.0 */
/* Palpate for other programs: load a touchable head (head.glb), ask for its surface and curves, and
 * run the haptic tick. docs/embedding.md shows a loop.
 *
 * Units: mm, N, s; stiffness N/mm. Frame: the head's, +x to the subject's left, +y up, +z out of
 * the face; palpate_head_to_scan() gives the scan's own numbers.
 *
 * No global state, and no exception leaves a function. Threads: a head is immutable, so any number
 * of threads may use one at once; a touch is the memory of one tool and belongs to one thread at a
 * time. Handles may be freed in any order: a touch keeps its head.
 */
#ifndef PALPATE_H
#define PALPATE_H

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32)
#define PALPATE_API __declspec(dllimport)
#elif defined(__GNUC__)
#define PALPATE_API __attribute__((visibility("default")))
#else
#define PALPATE_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Grows when a struct or a function changes in a way that old programs cannot bear. */
#define PALPATE_ABI 1

typedef enum palpate_status {
  PALPATE_OK = 0,
  PALPATE_BAD_ARGUMENT = 1, /* a null pointer, an option or an index out of range */
  PALPATE_BAD_INPUT = 2,    /* the file is not a touchable head, or a damaged one */
  PALPATE_NO_FILE = 3,      /* it cannot be read */
  PALPATE_NO_MEMORY = 4,
  PALPATE_BUG = 5 /* please report */
} palpate_status;

/* What went wrong, in one line; filled by the functions that take it where they do not return
 * PALPATE_OK. May be null. */
typedef struct palpate_error {
  palpate_status status;
  char text[500]; /* UTF-8, ends with 0, cut where longer */
} palpate_error;

typedef struct palpate_head palpate_head;
typedef struct palpate_touch palpate_touch;

/* "0.1.0" */
PALPATE_API const char* palpate_version(void);
/* PALPATE_ABI of the library; differs from the header's where the two do not fit. */
PALPATE_API uint32_t palpate_abi(void);

/* ---- Head ------------------------------------------------------------------------------------ */

/* @param path         head.glb, UTF-8
 * @param tool_radius  [mm] of the sphere that will touch; 0 takes the one that the map was pressed
 *                     with. Another one is allowed and warned about.
 * @param head         receives the handle; null on failure
 * Takes about a second per million triangles; never call it from the haptic thread. */
PALPATE_API palpate_status palpate_head_load(const char* path, double tool_radius,
                                             palpate_head** head, palpate_error* error);
/* The same from the file's bytes, which are not needed afterwards. */
PALPATE_API palpate_status palpate_head_parse(const void* bytes, size_t size, double tool_radius,
                                              palpate_head** head, palpate_error* error);
/* Null is allowed. */
PALPATE_API void palpate_head_free(palpate_head* head);

typedef struct palpate_head_facts {
  uint64_t vertices;    /* of the scan; numbers of vertices below are from 0 to this */
  uint64_t triangles;   /* that can be touched */
  uint64_t fingerprint; /* of all that a force depends on */
  uint32_t forces;      /* samples per curve */
  double tool_radius;   /* [mm] that touches */
  double map_radius;    /* [mm] that the map was pressed with */
  double unit_mm;       /* [mm] per unit of the scan */
  double low[3];        /* [mm] bounding box, head frame */
  double high[3];
} palpate_head_facts;
PALPATE_API palpate_status palpate_head_describe(const palpate_head* head,
                                                 palpate_head_facts* facts);
/* What a user should know about the head, one line each; null from the count on. */
PALPATE_API const char* palpate_head_warning(const palpate_head* head, uint32_t index);

/* A point in the scan's own numbers to the head's frame [mm], and back. */
PALPATE_API palpate_status palpate_head_from_scan(const palpate_head* head, const double scan[3],
                                                  double point[3]);
PALPATE_API palpate_status palpate_head_to_scan(const palpate_head* head, const double point[3],
                                                double scan[3]);

/* Curve of a vertex: `forces` values each. Either array may be null.
 * @param travel     [mm] of the tool from first contact at each force
 * @param estimated  1 where the curve was carried over from neighbours (eyes, nose, lips, ears,
 *                   neck), 0 where it was computed; may be null */
PALPATE_API palpate_status palpate_head_curve(const palpate_head* head, uint64_t vertex,
                                              double* force, double* travel, int32_t* estimated);

/* A place on the skin. */
typedef struct palpate_place {
  double point[3];    /* [mm] */
  double normal[3];   /* [-] unit, outwards */
  double distance;    /* [mm] to the asked position; negative where that is inside */
  double weight[3];   /* [-] of the three vertices, sum 1 */
  uint64_t vertex[3]; /* of the scan */
  int32_t region;     /* palpate_region_name() */
  int32_t estimated;  /* 1 where a corner's curve was carried over */
} palpate_place;
/* The point of the skin nearest to a position [mm]. Allocates nothing. */
PALPATE_API palpate_status palpate_head_nearest(const palpate_head* head, const double position[3],
                                                palpate_place* place);
/* Force [N] and slope [N/mm] of the place's blended curve at a depth [mm]; either may be null.
 * Allocates nothing. */
PALPATE_API palpate_status palpate_head_press(const palpate_head* head, const palpate_place* place,
                                              double depth, double* force, double* stiffness);
/* "forehead"; null where there is no such region. */
PALPATE_API const char* palpate_region_name(int32_t region);

/* ---- Touch ----------------------------------------------------------------------------------- */

typedef struct palpate_touch_options {
  uint32_t size;           /* set by palpate_touch_defaults(); leave alone */
  int32_t ratio;           /* 1: all forces times one factor, so that a weak device keeps the ratios
                              between regions; 0: forces as mapped, clipped to the device */
  int32_t passivity;       /* 1: the passivity controller acts */
  double peak_force;       /* [N] of the device, > 0 */
  double stiffness;        /* [N/mm] largest that it renders stably, > 0 */
  double damping;          /* [N s/mm] >= 0 */
  double static_friction;  /* [-] 0 to 2 */
  double kinetic_friction; /* [-] 0 to static_friction */
  double viscous;          /* [N s/mm] drag in contact */
  double rate;             /* [s/mm] force times (1 + rate * speed of indenting) */
  double slew;             /* [N/s] fastest change of the force, > 0 */
  double soft_start;       /* [s] ramp when a contact begins inside the head, >= 0 */
  double resolution; /* [mm] step of the reported position, felt at a tenth at rest; 0: none */
} palpate_touch_options;

/* The project's defaults for a device by name ("falcon", "omega.3", "Touch X", "inverse3";
 * "published" for the Falcon at 8.7 N), or for an unlimited one where the name is null. What the
 * device itself reports should overrule them.
 * PALPATE_BAD_ARGUMENT where the name is unknown or fits several devices. */
PALPATE_API palpate_status palpate_touch_defaults(const char* device,
                                                  palpate_touch_options* options);

/* @param options  null for the defaults of an unlimited device */
PALPATE_API palpate_status palpate_touch_new(const palpate_head* head,
                                             const palpate_touch_options* options,
                                             palpate_touch** touch, palpate_error* error);
/* Null is allowed. */
PALPATE_API void palpate_touch_free(palpate_touch* touch);
/* Device force over mapped force; below 1 for a device weaker than the tissue. */
PALPATE_API double palpate_touch_scale(const palpate_touch* touch);
/* What was scaled or flattened for this device, one line each; null from the count on. */
PALPATE_API const char* palpate_touch_warning(const palpate_touch* touch, uint32_t index);

typedef struct palpate_tick_input {
  double position[3];   /* [mm] of the tool's centre, head frame */
  double velocity[3];   /* [mm/s] as the device reports it */
  double dt;            /* [s] since the last tick; clipped to 0.0001 ... 0.01 */
  int32_t has_velocity; /* 0: estimated from the positions */
  int32_t hold;         /* 1: no force (clutch, pause); what comes after is a fresh, soft start */
} palpate_tick_input;

typedef struct palpate_tick_output {
  double force[3];   /* [N] for the device, head frame */
  double normal[3];  /* [-] direction of the elastic push; 0 in free space */
  double point[3];   /* [mm] touched point of the skin */
  double depth;      /* [mm] */
  double map_force;  /* [N] of the blended map at that depth */
  double stiffness;  /* [N/mm] its slope there */
  double elastic;    /* [N] the same as this device renders it */
  double damped;     /* [N] taken away by the passivity controller */
  double weight[3];  /* [-] of the touched triangle's vertices */
  int64_t vertex[3]; /* of the scan; -1 in free space */
  int32_t region;
  int32_t in_contact;
  int32_t estimated; /* 1 where a corner's curve was carried over */
  int32_t limited;   /* bit 0: the force limit acted, bit 1: the slew limit */
  int32_t finite;    /* 0: the input was not finite; force 0 and a fresh start */
} palpate_tick_output;

/* One tick: position in, force out; call it at 1 kHz or more. About 1 us. Allocates nothing, takes
 * no lock, makes no system call. Null pointers do nothing and return PALPATE_BAD_ARGUMENT. */
PALPATE_API palpate_status palpate_touch_tick(palpate_touch* touch, const palpate_tick_input* input,
                                              palpate_tick_output* output);
/* Forgets the contact: the next tick starts afresh. Same rules as the tick. */
PALPATE_API void palpate_touch_reset(palpate_touch* touch);
/* [N mm] energy that the passivity controller has taken out since the start. */
PALPATE_API double palpate_touch_removed(const palpate_touch* touch);

#ifdef __cplusplus
}
#endif
#endif
