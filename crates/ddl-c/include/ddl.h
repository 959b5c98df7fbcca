// Forecasts of pedestrians: from live tracks to where everybody will be during the next 4.8 s, with joint futures, risk
// of plans and occupancy. From C++ include ddl.hpp. Made by cbindgen from the crate ddl-c; do not edit.
//
// - Functions return a status; ddl_last_error() has the words. No panic of Rust leaves a function.
// - A null pointer where one is needed, a wrong number or plan is DDL_STATUS_INVALID. Nobody checks that a pointer
//   leads to as many values as stated, or to a handle that is not freed.
// - Lengths are metres, times seconds. What a pointer to const leads to is not changed, nor kept after the call.
// - Structures of options may be all zero, where nothing else is said.

#ifndef DDL_H
#define DDL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// What a call returns. `ddl_last_error` has the words.
typedef enum ddl_status {
  // It has done what was asked.
  DDL_STATUS_OK = 0,
  // An argument is wrong: a null pointer, a number, a plan, a frame out of order. Nothing has changed.
  DDL_STATUS_INVALID = 1,
  // A file is missing, unreadable, or does not hold what it should.
  DDL_STATUS_FILE = 2,
  // A defect of the library. Free the handles of the call; others are unharmed.
  DDL_STATUS_DEFECT = 3,
} ddl_status;

// A forecast and the answers about it, in memory that the next forecast uses again. One thread at a time.
typedef struct ddl_forecast ddl_forecast;

// The tracks of one place. Calls of several threads wait for each other. It keeps its model, which may be freed.
typedef struct ddl_live ddl_live;

// A trained model. Any number of threads may use it at the same time.
typedef struct ddl_model ddl_model;

// A position on the ground, metres.
typedef struct ddl_point {
  // Along the first axis.
  double x;
  // Along the second axis.
  double y;
} ddl_point;

// A row of a plan.
typedef struct ddl_plan_point {
  // Seconds after the moment of the forecast, ascending.
  double time;
  // Metres.
  struct ddl_point position;
  // Radius of the robot or person that follows the plan, metres.
  double radius;
} ddl_plan_point;

// The path of a robot over time, with straight lines between its rows.
typedef struct ddl_plan {
  // The rows.
  const struct ddl_plan_point *points;
  // Their number.
  size_t count;
} ddl_plan;

// What is forecast. All zero, or null instead of it: the hypotheses of each pedestrian alone.
typedef struct ddl_request {
  // Futures of the whole scene instead, for risk and occupancy: hypothesis k of every pedestrian is future k.
  bool joint;
  // With `joint`: a plan that the pedestrians respond to; all zero without one.
  struct ddl_plan plan;
  // The id of the pedestrian who follows that plan; null if it is somebody else, such as a robot. In a live frame
  // without this pedestrian it is somebody else too.
  const int64_t *ego;
} ddl_request;

// How a place is observed. All zero: times in seconds, pedestrians from the first row on, every frame, no memory.
typedef struct ddl_live_options {
  // Frames per second, if frames are numbered; 0 if they have times in seconds.
  double rate;
  // The file of the memory of the place, which is made if there is none; null without a memory.
  const char *memory;
  // Only pedestrians tracked for all 8 steps.
  bool whole;
  // For so long (s, 0 to 2) a pedestrian without a new row is carried on; null: for 0.4 s, or as its rows come.
  const double *max_age;
  // Seconds (0 to 2) between two forecasts; 0 for one at every frame. All frames count for the observation.
  double every;
} ddl_live_options;

// Where a tracker sees a pedestrian.
typedef struct ddl_observation {
  // Any number, the same as long as it is the same pedestrian.
  int64_t id;
  // Metres.
  struct ddl_point position;
} ddl_observation;

// A pedestrian whose row does not fit its track: it is left out, or begins the track anew.
typedef struct ddl_misfit {
  // The pedestrian.
  int64_t id;
  // Distance from where it was expected, metres.
  double distance;
} ddl_misfit;

// A forecast of N pedestrians with K hypotheses of 12 positions, 0.4 s apart: arrays in C order, valid until the next
// forecast of the same handle. An array that does not apply is null.
typedef struct ddl_view {
  // Whether the forecast was made at the last frame. False between two forecasts (option `every`): it is then of an
  // earlier frame; misfits, memory and warning are always of the last frame.
  bool due;
  // N, the number of pedestrians that are forecast; may be 0. Who is where nobody can be is not: see the misfits.
  size_t pedestrians;
  // K.
  size_t hypotheses;
  // `[N]`.
  const int64_t *ids;
  // `[N][8]`: the observation that it is made from, 0.4 s apart.
  const struct ddl_point *past;
  // `[N]`: seconds since the last row.
  const double *age;
  // `[N]`: what the observation adds to the error after 4.8 s, metres.
  const double *uncertainty;
  // `[N][K][12]`.
  const struct ddl_point *paths;
  // `[N][K]`; they sum to 1 for each pedestrian.
  const double *weights;
  // `[N][K]`.
  const struct ddl_point *goals;
  // `[N][K]`: the verdict of the certificate: the distance to the goal falls at every step, and the bounds are kept.
  const bool *certified;
  // `[N]`: share of training motions that are at least as unusual as the observed one.
  const double *familiarity;
  // `[N][12]`: scale of Student's t, three degrees of freedom, around the hypothesis that is followed, metres.
  const double *spread;
  // `[misfit_count]`: rows that this frame showed to be wrong, and tracks that it began anew.
  const struct ddl_misfit *misfits;
  // Their number.
  size_t misfit_count;
  // Segments in the memory of the place; 0 without one.
  size_t remembered;
  // What is wrong with the memory of the place, or doubtful of the plan, though there is a forecast; null if
  // nothing.
  const char *warning;
} ddl_view;

// The risk of P plans: probabilities that somebody comes close within 4.8 s.
typedef struct ddl_risks {
  // P.
  size_t plans;
  // N.
  size_t pedestrians;
  // `[P]`: that anybody does.
  const double *total;
  // `[P][N]`: that this pedestrian does.
  const double *of_each;
  // `[P][12]`: that somebody is close during this step.
  const double *steps;
  // `[P][12]`: that somebody was close by the end of this step.
  const double *until;
  // What is doubtful of the plans, which are counted from 0: their unit, times or place. Null if nothing is.
  const char *warning;
} ddl_risks;

// The cells and times of an occupancy.
typedef struct ddl_cells {
  // Side of a cell, metres; above 0.
  double cell;
  // Seconds between two grids; the first is at the moment itself.
  double every;
  // Radius of a pedestrian, metres; 0.2 if nothing else is known.
  double radius;
  // Two corners, the lowest x and y first; null for the smallest area around all paths.
  const struct ddl_point (*corners)[2];
  // Metres around all paths, without corners.
  double margin;
} ddl_cells;

// Probabilities that a pedestrian covers the middle of a cell.
typedef struct ddl_occupancy {
  // Number of grids.
  size_t times;
  // Cells along x.
  size_t width;
  // Cells along y.
  size_t height;
  // The corner with the lowest x and y.
  struct ddl_point origin;
  // Side of a cell, metres.
  double cell;
  // Number of pedestrians who are too far from the others for the area; 0 where corners are given.
  size_t outside;
  // `[times]`: seconds after the moment.
  const double *time;
  // `[times][height][width]`, the row of the lowest y first.
  const float *probabilities;
} ddl_occupancy;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The version of the library, such as "0.2.0".
const char *ddl_version(void);

// What was wrong in the last call on this thread that failed: what, where, and what to do. Valid until the next
// failure on this thread; empty before the first.
const char *ddl_last_error(void);

// Takes so many bytes from the system now, for the pool of the library, so that later calls need not: 24 MB are enough
// for 25 pedestrians. Without the feature `pool` it has no effect.
enum ddl_status ddl_reserve(size_t bytes);

// Opens a model: "world", which is built in, a packed model, or the folder of a run. With `threads` 1 everything is
// computed on the thread that calls, with its priority; each thread that calls takes some kB for good. Otherwise the
// model has so many threads of its own; 0 for one on each core.
enum ddl_status ddl_model_open(const char *name, size_t threads, struct ddl_model **model);

// Frees a model; live tracks keep what they need of it. Null is nothing, as in all functions that free.
void ddl_model_free(struct ddl_model*);

// A place for forecasts. It takes memory when it is filled, and uses it again.
struct ddl_forecast *ddl_forecast_new(void);

// Frees a forecast with everything that it has shown.
void ddl_forecast_free(struct ddl_forecast*);

// Forecasts `count` pedestrians whose last 8 positions are known: `past` is `[count][8]`, 0.4 s apart, the present
// last. They have the ids 0, 1, 2 and so on. Positions are checked as those of a stream: who is where nobody can be is
// not forecast (see ids and misfits), and without anybody else that is an error. `request` may be null.
enum ddl_status ddl_model_forecast(const struct ddl_model *model,
                                   const struct ddl_point *past,
                                   size_t count,
                                   const struct ddl_request *request,
                                   struct ddl_forecast *forecast);

// Begins to observe a place. `options` may be null.
enum ddl_status ddl_live_new(const struct ddl_model *model,
                             const struct ddl_live_options *options,
                             struct ddl_live **live);

// Adds a frame with all observed pedestrians, in any order, and writes the forecast to `forecast`. N is 0 if no
// pedestrian can be forecast. Between two forecasts (option `every`), `forecast` keeps the previous one and `due` is
// false. `at` is the time in seconds or the frame number; it must increase. After an error the tracks are unchanged,
// and the corrected frame can be added. `request` may be null.
enum ddl_status ddl_live_observe(const struct ddl_live *live,
                                 double at,
                                 const struct ddl_observation *observations,
                                 size_t count,
                                 const struct ddl_request *request,
                                 struct ddl_forecast *forecast);

// Forgets all tracks, as when a tracker restarts; the memory of the place is kept.
enum ddl_status ddl_live_clear(const struct ddl_live *live);

// Writes the memory of the place and closes its file; nothing without one. While frames come it is written once a
// minute.
enum ddl_status ddl_live_close(const struct ddl_live *live);

// Frees live tracks. It does not write the memory: `ddl_live_close` does.
void ddl_live_free(struct ddl_live*);

// What was forecast last; null for null. Valid until the next forecast into the handle.
const struct ddl_view *ddl_forecast_view(const struct ddl_forecast *forecast);

// Radii (m) `[N][K][12]` of the discs around the hypotheses that together contain a pedestrian with the probability
// `level`. NaN: the hypothesis has no disc. Null: no pedestrian is forecast. Valid until the next call for radii of
// the handle.
enum ddl_status ddl_forecast_radii(struct ddl_forecast *forecast, double level, const double **radii);

// The risk that somebody comes within `within` metres of the edge of each plan, from joint futures. People see a plan
// and keep away from it as from a pedestrian, unless `unseen`. `ego` is the id of the pedestrian who follows the
// plans; null if it is somebody else, such as a robot. Valid until the next call for risks of the handle.
enum ddl_status ddl_forecast_risks(struct ddl_forecast *forecast,
                                   const struct ddl_plan *plans,
                                   size_t count,
                                   double within,
                                   const int64_t *ego,
                                   bool unseen,
                                   const struct ddl_risks **risks);

// Grids of the probability that a pedestrian covers the middle of a cell, from joint futures, at 0, `every`, .. 4.8 s.
// Valid until the next call for occupancy of the handle.
enum ddl_status ddl_forecast_occupancy(struct ddl_forecast *forecast,
                                       const struct ddl_cells *cells,
                                       const struct ddl_occupancy **occupancy);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* DDL_H */
