/* How far does a gust push a drone on its tether? A drone in C, and `TetherDynamic` for FMI 2, which goes back in time.

    tetherfmu build TetherDynamic --native --header --preset drone --segments 10 --out native
    python -m zipfile --extract native/TetherDynamic.fmu native/TetherDynamic
    export LD_LIBRARY_PATH=native/TetherDynamic/binaries/linux64
    FMI=$(python -c "import fmpy, os; print(os.path.dirname(fmpy.__file__))")/c-code
    cc examples/hosts/tethered_drone.c -I native -I $FMI $LD_LIBRARY_PATH/TetherDynamic.so -lm -o tethered_drone
    ./tethered_drone

The drone hovers 60 m above the winch and holds its place by its position and its velocity. In each step it moves under a
guess of the force at the end of the step, the tether follows it there, and its force is the next guess: the FMU returns to
the start of the step until both agree. At 5 s the wind rises from 4 to 12 m/s. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "TetherDynamic.h"
#include "fmi2Functions.h"

enum { STEPS = 1000, SECOND = 50, MOST = 20 }; /* steps, in a second; repetitions of a step */
static const double H = 0.02, MASS = 6.0, LENGTH = 61.0;                               /* [s], [kg], [m] */
static const double HOME[3] = {0.0, 0.0, 60.0}, SPRING = 20.0, DAMPER = 22.0;        /* [m], [N/m], [N s/m] */
static const double DRAG = 0.5 * 1.225 * 0.15, CALM = 4.0, GUST = 12.0, AGREED = 0.01; /* [N s2/m2], [m/s], [m/s], [N] */

typedef struct {
    double position[3], velocity[3];
} Drone;

static const fmi2ValueReference KITE[6] = {TETHER_KITE_POSITION_1, TETHER_KITE_POSITION_2, TETHER_KITE_POSITION_3,
                                           TETHER_KITE_VELOCITY_1, TETHER_KITE_VELOCITY_2, TETHER_KITE_VELOCITY_3};
static const fmi2ValueReference FORCE[3] = {TETHER_KITE_FORCE_1, TETHER_KITE_FORCE_2, TETHER_KITE_FORCE_3};
static const fmi2ValueReference WIND = TETHER_WIND_VELOCITY_1, START_LENGTH = TETHER_INITIAL_LENGTH;
static fmi2Component tether;

static void check(fmi2Status status)
{
    if (status <= fmi2Warning) return;
    fprintf(stderr, "the FMU refused a call; its message says why\n");
    exit(1);
}

static double distance(const double *a, const double *b)
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

/* Acceleration [m/s2] of the drone in a wind along x [m/s] under a force of the tether [N]; its thrust carries its weight. */
static void accelerate(const Drone *drone, double wind, const double *force, double *acceleration)
{
    double air[3] = {wind - drone->velocity[0], -drone->velocity[1], -drone->velocity[2]}, none[3] = {0.0};
    double speed = distance(air, none);
    for (int i = 0; i < 3; i++) {
        double thrust = SPRING * (HOME[i] - drone->position[i]) - DAMPER * drone->velocity[i];
        acceleration[i] = (thrust + DRAG * speed * air[i] + force[i]) / MASS;
    }
}

/* The drone a step later, under a force that changes linearly [N]: Heun's method. */
static Drone moved(const Drone *drone, double wind, const double *from, const double *to)
{
    double first[3], last[3];
    Drone end = *drone;
    accelerate(drone, wind, from, first);
    for (int i = 0; i < 3; i++) {
        end.velocity[i] += H * first[i];
        end.position[i] += H * drone->velocity[i] + 0.5 * H * H * first[i];
    }
    accelerate(&end, wind, to, last);
    for (int i = 0; i < 3; i++) {
        end.velocity[i] = drone->velocity[i] + 0.5 * H * (first[i] + last[i]);
        end.position[i] = drone->position[i] + H * drone->velocity[i] + H * H * (2.0 * first[i] + last[i]) / 6.0;
    }
    return end;
}

/* Inputs that lead the end of the tether to the drone: it moves by v h + a h^2/2 with a = r (v - v_last)/h, r = 1, 0 at first. */
static void lead(const Drone *to, const double *last, double r, double *inputs)
{
    for (int i = 0; i < 3; i++) {
        double v = inputs[3 + i] = (to->velocity[i] + r * last[i]) / (1.0 + r);
        inputs[i] = to->position[i] - H * v - 0.5 * H * r * (v - last[i]);
    }
}

static void start(double *force)
{
    static const fmi2CallbackFunctions CALLBACKS = {NULL, calloc, free, NULL, NULL};
    tether = fmi2Instantiate("tether", fmi2CoSimulation, TETHER_GUID, "", &CALLBACKS, fmi2False, fmi2False);
    if (!tether) exit(1);
    check(fmi2SetupExperiment(tether, fmi2False, 0.0, 0.0, fmi2False, 0.0));
    check(fmi2SetReal(tether, &START_LENGTH, 1, &LENGTH));
    check(fmi2SetReal(tether, KITE, 3, HOME));
    check(fmi2SetReal(tether, &WIND, 1, &CALM));
    check(fmi2EnterInitializationMode(tether));
    check(fmi2ExitInitializationMode(tether));
    check(fmi2GetReal(tether, FORCE, 3, force));
}

/* One step from a time [s]; returns how often the tether did it. `last`: velocity that led it before; all are modified. */
static int step(double time, double wind, Drone *drone, double *force, double *last, fmi2FMUstate *before)
{
    double guess[3] = {force[0], force[1], force[2]}, inputs[6], found[3];
    check(fmi2GetFMUstate(tether, before)); /* the same memory each time */
    for (int count = 1; count <= MOST; count++) {
        Drone end = moved(drone, wind, force, guess);
        lead(&end, last, time > 0.0 ? 1.0 : 0.0, inputs);
        check(fmi2SetReal(tether, KITE, 6, inputs));
        check(fmi2SetReal(tether, &WIND, 1, &wind));
        check(fmi2DoStep(tether, time, H, fmi2True));
        check(fmi2GetReal(tether, FORCE, 3, found));
        double apart = distance(found, guess);
        for (int i = 0; i < 3; i++) guess[i] = found[i];
        if (apart < AGREED) {
            *drone = end;
            for (int i = 0; i < 3; i++) force[i] = found[i], last[i] = inputs[3 + i];
            return count;
        }
        check(fmi2SetFMUstate(tether, *before)); /* back to the start of the step */
    }
    fprintf(stderr, "drone and tether do not agree: take a shorter step\n");
    exit(1);
}

int main(void)
{
    double force[3], last[3] = {0.0}, farthest = 0.0, none[3] = {0.0};
    int count = 0;
    fmi2FMUstate before = NULL;
    Drone drone = {{HOME[0], HOME[1], HOME[2]}, {0.0}};
    start(force);
    for (int k = 0; k < STEPS; k++) {
        count += step(H * k, H * k < 5.0 ? CALM : GUST, &drone, force, last, &before);
        if (distance(drone.position, HOME) > farthest) farthest = distance(drone.position, HOME);
        if ((k + 1) % (4 * SECOND) == 0)
            printf("%4.0f s  drone at x %6.3f m, z %6.3f m  force of the tether %6.2f N\n", H * (k + 1), drone.position[0],
                   drone.position[2], distance(force, none));
    }
    printf("farthest %.3f m from home; %.2f tether steps for each step\n", farthest, (double)count / STEPS);
    check(fmi2FreeFMUstate(tether, &before));
    fmi2FreeInstance(tether);
    return 0;
}
