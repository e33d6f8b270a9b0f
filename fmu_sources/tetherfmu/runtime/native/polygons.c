/* Detects polygonal input paths, from importers that interpolate linearly between widely spaced rows: as polygons.py. */
#include "polygons.h"

#include <math.h>
#include <string.h>

#include "tables.h"

static double length_of(const double *vector)
{
    return sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]);
}

/* Begin with a new path, as at a start. */
void watch_anew(Watch *watch)
{
    memset(watch, 0, sizeof *watch);
}

/* Begin anew after a restored state; steps judged before still count. */
void forget_path(Watch *watch)
{
    int judged = watch->judged;
    bool is_over = watch->is_over;
    watch_anew(watch);
    watch->judged = judged;
    watch->is_over = is_over;
}

/* Count a step by how much its displacement differs from the one before, `bend` [m], and from its velocity, `off` [m]. */
static void judge(Watch *watch, double bend, double off, double length, double size, bool is_alike)
{
    if (!is_alike || (bend > POLYGON_ROUNDING * size && bend <= POLYGON_BENT * length)) {
        watch->straight = watch->corners = watch->period = 0;
    } else if (bend <= POLYGON_ROUNDING * size) {
        watch->straight++;
    } else {
        bool is_explained = off <= POLYGON_BENT * length;
        bool is_regular = watch->straight > 0 && watch->straight + 1 == watch->period && !is_explained;
        watch->corners = is_regular ? watch->corners + 1 : 0;
        watch->period = watch->straight + 1;
        watch->straight = 0;
    }
}

/* The number of steps from corner to corner, once it is known, and before that 0.

position [m], velocity [m/s] : of the end at the start of the step [s]. */
int period_of(Watch *watch, const double *position, const double *velocity, double step)
{
    double now[3], turned[3], off[3], last = watch->step;
    bool had_before = watch->has_before, had_way = watch->has_way;
    for (int i = 0; i < 3; i++) {
        now[i] = position[i] - watch->before[i];
        turned[i] = now[i] - watch->way[i];
        off[i] = now[i] - last * velocity[i];
        watch->before[i] = position[i];
        watch->way[i] = now[i];
    }
    watch->step = step;
    watch->has_before = true;
    watch->has_way = had_before;
    double length = length_of(now);
    if (!had_way || length == 0.0) return 0;
    watch->judged++;
    judge(watch, length_of(turned), length_of(off), length, length_of(position), fabs(step - last) <= POLYGON_ALIKE * step);
    watch->is_over = watch->judged > POLYGON_JUDGED || watch->corners >= POLYGON_CORNERS;
    return watch->corners >= POLYGON_CORNERS ? watch->period : 0;
}
