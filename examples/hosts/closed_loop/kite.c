/* Apparent wind v_a = v_w - v, dynamic pressure q = rho |v_a|^2/2, unit vector r from the ground station to the kite.

    lift      q S C_L  along y x v_a, y = r x heading the span: across the apparent wind, away from the ground station
    drag      q S C_D (1 + k |u|)  along v_a
    turning   the heading turns about r by c1 |v_a| u + (c2/|v_a|) sin(psi) cos(beta)

u steering, positive turns right as seen from the ground station; psi heading from the direction to the zenith, positive to
the right; beta elevation. Model, coefficients and sources are those of examples/fmus/aerodynamics.py. The controller aims at
a point of the circle ahead of the kite and solves the turn rate law for the steering. */
#include "kite.h"

#include <math.h>

static const double AIR_DENSITY = 1.225, WING_AREA = 19.8;           /* rho [kg/m3], S [m2] */
static const double LIFT = 0.59, DRAG = 0.164, STEERING_DRAG = 0.6;  /* C_L, C_D, k [-] */
static const double TURNING = 0.0613, TURNING_BY_WEIGHT = 1.226;     /* c1 [rad/m], c2 [m/s2] */
static const double ELEVATION = 0.5, RADIUS = 0.35, LOOK_AHEAD = 0.5; /* of the circle, seen from the ground station [rad] */
static const double COURSE_GAIN = 1.5, SLOWEST = 3.0, PI = 3.141592653589793; /* [1/s], least apparent wind [m/s], - */

Vector sum(Vector a, double factor, Vector b)
{
    return (Vector){a.x + factor * b.x, a.y + factor * b.y, a.z + factor * b.z};
}

static double dot(Vector a, Vector b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static Vector cross(Vector a, Vector b)
{
    return (Vector){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

double norm(Vector a)
{
    return sqrt(dot(a, a));
}

static Vector unit(Vector a)
{
    return sum((Vector){0.0, 0.0, 0.0}, 1.0 / norm(a), a);
}

/* Component of a vector along r x z: to the right. */
static double rightward(Vector a, Vector r)
{
    return a.x * r.y - a.y * r.x;
}

/* Angle from the zenith to the right of what a vector has across r [rad]. */
static double angle_of(Vector a, Vector r)
{
    return atan2(rightward(a, r), a.z - dot(a, r) * r.z);
}

/* Direction to the point of the circle at an angle, from its right end on to its top [rad]. */
static Vector on_circle(double angle)
{
    const Vector axis = {cos(ELEVATION), 0.0, sin(ELEVATION)}, up = {-axis.z, 0.0, axis.x}, right = {0.0, -1.0, 0.0};
    const Vector across = sum(sum((Vector){0.0, 0.0, 0.0}, cos(angle), right), sin(angle), up);
    return sum(sum((Vector){0.0, 0.0, 0.0}, cos(RADIUS), axis), sin(RADIUS), across);
}

/* Angle of the nearest point of the circle [rad]; r : direction to the kite. */
static double place_on_circle(Vector r)
{
    return atan2(r.z * cos(ELEVATION) - r.x * sin(ELEVATION), -r.y);
}

static double limited(double number, double largest)
{
    return fmin(fmax(number, -largest), largest);
}

Vector start_of_circle(double distance)
{
    return sum((Vector){0.0, 0.0, 0.0}, distance, on_circle(0.0));
}

Kite first_kite(Vector position)
{
    const Vector r = unit(position), ahead = on_circle(place_on_circle(r) + LOOK_AHEAD);
    return (Kite){unit(sum(ahead, -dot(ahead, r), r)), 0.0};
}

Vector load_of_air(Kite *kite, Vector position, Vector velocity, Vector wind)
{
    const Vector r = unit(position), felt = sum(wind, -1.0, velocity), target = on_circle(place_on_circle(r) + LOOK_AHEAD);
    const double speed = norm(felt), least = fmax(speed, SLOWEST);
    const double error = remainder(angle_of(target, r) - angle_of(kite->heading, r), 2.0 * PI);
    const double by_weight = TURNING_BY_WEIGHT / least * rightward(kite->heading, r);
    const double steering = limited((COURSE_GAIN * error - by_weight) / (TURNING * least), 1.0);
    kite->rate = TURNING * least * steering + by_weight;
    const double area = 0.5 * AIR_DENSITY * WING_AREA * speed; /* q S over the apparent wind */
    const Vector across = unit(cross(cross(r, kite->heading), felt));
    const Vector drag = sum((Vector){0.0, 0.0, 0.0}, area * DRAG * (1.0 + STEERING_DRAG * fabs(steering)), felt);
    return sum(drag, area * LIFT * speed, across);
}

void turn(Kite *kite, Vector position, double time)
{
    const Vector r = unit(position), x = unit(sum(kite->heading, -dot(kite->heading, r), r));
    const double angle = kite->rate * time;
    kite->heading = sum(sum((Vector){0.0, 0.0, 0.0}, cos(angle), x), sin(angle), cross(r, x));
}
