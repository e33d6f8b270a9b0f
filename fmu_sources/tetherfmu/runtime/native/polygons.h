/* Detects polygonal input paths of the kite end; see polygons.py, which has the rule. */
#ifndef POLYGONS_H
#define POLYGONS_H

#include <stdbool.h>

typedef struct {
    double before[3], way[3]; /* position of the step before [m], and the displacement to it */
    double step;              /* [s], before */
    int straight, period, corners, judged;
    bool has_before, has_way, is_over;
} Watch;

void watch_anew(Watch *watch);
void forget_path(Watch *watch);
int period_of(Watch *watch, const double *position, const double *velocity, double step);

#endif
