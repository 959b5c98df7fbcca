// After two frames no call asks the C heap or the system for memory: a thousand frames of 25 people, on the calling thread
// and on two threads of the model, with joint futures, risk and occupancy in every tenth. This program stands in for
// malloc and its kin, and for mmap and its kin, in all that it has loaded.
#define _GNU_SOURCE
#include <ddl.h>
#include <dlfcn.h>
#include <math.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

enum { WARM = 2, FRAMES = 1000 };

static atomic_bool counting;
static atomic_long calls;

static void count(void) {
    if (atomic_load(&counting)) atomic_fetch_add(&calls, 1);
}

extern void *__libc_malloc(size_t);
extern void *__libc_calloc(size_t, size_t);
extern void *__libc_realloc(void *, size_t);
extern void *__libc_memalign(size_t, size_t);
extern void __libc_free(void *);

void *malloc(size_t size) { return count(), __libc_malloc(size); }
void *calloc(size_t number, size_t size) { return count(), __libc_calloc(number, size); }
void *realloc(void *old, size_t size) { return count(), __libc_realloc(old, size); }
void free(void *old) { count(), __libc_free(old); }
void *memalign(size_t alignment, size_t size) { return count(), __libc_memalign(alignment, size); }
void *aligned_alloc(size_t alignment, size_t size) { return memalign(alignment, size); }
int posix_memalign(void **place, size_t alignment, size_t size) {
    *place = memalign(alignment, size);
    return *place ? 0 : 12;
}

#define NEXT(name) ((__typeof__(name) *)dlsym(RTLD_NEXT, #name))
void *mmap(void *place, size_t size, int protection, int flags, int file, off_t offset) {
    return count(), NEXT(mmap)(place, size, protection, flags, file, offset);
}
int munmap(void *place, size_t size) { return count(), NEXT(munmap)(place, size); }
int madvise(void *place, size_t size, int advice) { return count(), NEXT(madvise)(place, size, advice); }
void *mremap(void *place, size_t size, size_t new_size, int flags, ...) {
    va_list more;
    va_start(more, flags);
    void *new_place = va_arg(more, void *);
    va_end(more);
    return count(), NEXT(mremap)(place, size, new_size, flags, new_place);
}
int brk(void *end) { return count(), NEXT(brk)(end); }
void *sbrk(intptr_t more) { return count(), NEXT(sbrk)(more); }

static void check(ddl_status status) {
    if (status != DDL_STATUS_OK) {
        fprintf(stderr, "error: %s\n", ddl_last_error());
        exit(1);
    }
}

// Ten times a second everybody walks round a circle of its own, so that the scene never ends.
static void frame(ddl_live *live, ddl_forecast *forecast, int tick) {
    ddl_observation seen[PEOPLE];
    for (int i = 0; i < PEOPLE; ++i) {
        const double radius = 2.0 + 0.2 * i, angle = (i % 2 ? 0.13 : -0.13) * tick / radius + i;
        seen[i].id = i;
        seen[i].position.x = 3.0 * (i % 5) + radius * cos(angle);
        seen[i].position.y = 3.0 * (i / 5) + radius * sin(angle);
    }
    ddl_request request = {0};
    request.joint = tick % 10 == 9;
    check(ddl_live_observe(live, 0.1 * tick, seen, PEOPLE, &request, forecast));
    const double *radii;
    check(ddl_forecast_radii(forecast, 0.9, &radii));
    if (request.joint) {
        const ddl_plan_point rows[] = {{0.0, {5.0, -3.0}, 0.3}, {4.8, {5.0, 3.0}, 0.3}};
        const ddl_plan plan = {rows, 2};
        const ddl_risks *risks;
        check(ddl_forecast_risks(forecast, &plan, 1, 0.5, NULL, false, &risks));
        const ddl_point corners[2] = {{-10.0, -10.0}, {25.0, 25.0}};
        const ddl_cells cells = {0.25, 0.8, 0.2, &corners, 0.0};
        const ddl_occupancy *occupancy;
        check(ddl_forecast_occupancy(forecast, &cells, &occupancy));
    }
}

static long page_faults(void) {
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_minflt;
}

int main(void) {
    int failures = 0;
    check(ddl_reserve(24 << 20));
    for (size_t threads = 1; threads <= 2; ++threads) {
        ddl_model *model;
        ddl_live *live;
        check(ddl_model_open("world", threads, &model));
        check(ddl_live_new(model, NULL, &live));
        ddl_forecast *forecast = ddl_forecast_new();
        for (int tick = 0; tick < WARM; ++tick) frame(live, forecast, tick);
        if (ddl_forecast_view(forecast)->pedestrians != PEOPLE) return 1;
        const long faults = page_faults();
        atomic_store(&calls, 0);
        atomic_store(&counting, true);
        for (int tick = WARM; tick < WARM + FRAMES; ++tick) frame(live, forecast, tick);
        atomic_store(&counting, false);
        const long counted = atomic_load(&calls);
        printf("%zu threads: %ld calls for memory in %d frames, %ld page faults\n", threads, counted, FRAMES,
               page_faults() - faults);
        failures += counted != 0;
        ddl_forecast_free(forecast);
        ddl_live_free(live);
        ddl_model_free(model);
    }
    return failures;
}
