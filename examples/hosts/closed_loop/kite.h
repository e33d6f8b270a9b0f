/* A soft kite as a point with a heading: the load of the air on it, and a controller that flies it on a circle. */
#ifndef KITE_H
#define KITE_H

typedef struct {
    double x, y, z;
} Vector;

typedef struct {
    Vector heading; /* unit vector across the position [-]: where the nose points */
    double rate;    /* turn rate of the heading about the position [rad/s] */
} Kite;

Vector sum(Vector a, double factor, Vector b); /* a + factor b */
double norm(Vector a);

/* Position [m] on the circle at a distance [m] from the ground station: where the circle begins. */
Vector start_of_circle(double distance);

/* A kite there, which flies along the circle. */
Kite first_kite(Vector position);

/* Steer the kite along the circle (its turn rate is modified): lift plus drag [N].

position [m], velocity [m/s] of the kite; wind [m/s] at the kite. */
Vector load_of_air(Kite *kite, Vector position, Vector velocity, Vector wind);

/* Turn the kite for a time [s] by its turn rate, to a heading across its new position [m]. */
void turn(Kite *kite, Vector position, double time);

#endif
