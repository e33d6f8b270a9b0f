/* How does a host in C++ fly a tether by FMI 3? A drone 100 m above a truck that drives off; prints the pull on the drone.

    tetherfmu build TetherDynamic --native --fmi 3 --out fmi3
    python -m zipfile --extract fmi3/TetherDynamic.fmu TetherDynamic
    headers=$(python -c 'import fmpy; print(fmpy.__path__[0])')/c-code
    c++ -std=c++17 examples/hosts/fly_from_cpp.cpp -I"$headers" -ldl -o fly_from_cpp
    ./fly_from_cpp TetherDynamic

The headers of FMI come with FMPy. For Linux; on macOS and Windows the path of the library differs, on Windows also
dlopen. `Tether` sets and gets vectors by their names: a start for a host of your own. */

#include <dlfcn.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "fmi3Functions.h"

#define FUNCTION(name) name##TYPE *const name = reinterpret_cast<name##TYPE *>(library(#name))

using Vector = std::array<double, 3>;

static void print_message(fmi3InstanceEnvironment, fmi3Status, fmi3String, fmi3String message) {
    std::fprintf(stderr, "%s\n", message);
}

static void check(fmi3Status status) {
    if (status > fmi3Warning) throw std::runtime_error("the FMU refused a call; its message says why");
}

/* A library that is open as long as this object lives; gives functions by their names. */
class Library {
    void *handle;

  public:
    explicit Library(const std::string &path) : handle(dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL)) {
        if (!handle) throw std::runtime_error(dlerror());
    }
    Library(const Library &) = delete;
    ~Library() { dlclose(handle); }
    void *operator()(const char *function) const {
        void *found = dlsym(handle, function);
        if (!found) throw std::runtime_error(std::string("the library of the FMU has no function ") + function);
        return found;
    }
};

/* The text of modelDescription.xml, in which attributes are found by plain search, each value reference once. */
class Description {
    std::string xml;
    std::map<std::string, fmi3ValueReference> known;

  public:
    explicit Description(const std::string &folder) {
        std::ifstream file(folder + "/modelDescription.xml");
        if (!file) throw std::runtime_error("the folder has no modelDescription.xml");
        xml.assign(std::istreambuf_iterator<char>(file), {});
    }
    /* An attribute of the first tag that contains `mark`, from a place on. */
    std::string attribute(const std::string &mark, const std::string &name, size_t from = 0) const {
        const size_t place = xml.find(mark, from);
        if (place == std::string::npos) throw std::runtime_error("the model description has no" + mark);
        const size_t found = xml.find(name + "=\"", xml.rfind('<', place));
        if (found == std::string::npos) throw std::runtime_error("the model description has no " + name);
        const size_t begin = found + name.size() + 2;
        return xml.substr(begin, xml.find('"', begin) - begin);
    }
    /* Value reference of a variable; an enumeration has the name of its type, which stands above the variables. */
    fmi3ValueReference reference(const std::string &variable) {
        const auto [entry, is_new] = known.try_emplace(variable);
        if (is_new) {
            const std::string text = attribute(" name=\"" + variable + "\"", "valueReference", xml.find("<ModelVariables"));
            entry->second = static_cast<fmi3ValueReference>(std::stoul(text));
        }
        return entry->second;
    }
};

/* One tether: sets and gets variables by name. A vector is one variable of FMI 3 with three values. */
class Tether {
    Description description;
    Library library;
    FUNCTION(fmi3InstantiateCoSimulation);
    FUNCTION(fmi3EnterInitializationMode);
    FUNCTION(fmi3ExitInitializationMode);
    FUNCTION(fmi3SetFloat64);
    FUNCTION(fmi3SetInt64);
    FUNCTION(fmi3GetFloat64);
    FUNCTION(fmi3DoStep);
    FUNCTION(fmi3FreeInstance);
    fmi3Instance instance;

  public:
    explicit Tether(const std::string &folder)
        : description(folder), library(folder + "/binaries/x86_64-linux/TetherDynamic.so"),
          instance(fmi3InstantiateCoSimulation(
              "tether", description.attribute(" instantiationToken=", "instantiationToken").c_str(), nullptr, fmi3False,
              fmi3True, fmi3False, fmi3False, nullptr, 0, nullptr, print_message, nullptr)) {
        if (!instance) throw std::runtime_error("the FMU gives no instance");
    }
    Tether(const Tether &) = delete;
    ~Tether() { fmi3FreeInstance(instance); }
    void set(const std::string &name, const std::vector<double> &values) {
        const fmi3ValueReference which = description.reference(name);
        check(fmi3SetFloat64(instance, &which, 1, values.data(), values.size()));
    }
    void choose(const std::string &name, fmi3Int64 number) { /* an enumeration */
        const fmi3ValueReference which = description.reference(name);
        check(fmi3SetInt64(instance, &which, 1, &number, 1));
    }
    Vector get(const std::string &name) {
        const fmi3ValueReference which = description.reference(name);
        Vector values{};
        check(fmi3GetFloat64(instance, &which, 1, values.data(), values.size()));
        return values;
    }
    void enter_initialization() { check(fmi3EnterInitializationMode(instance, fmi3False, 0.0, 0.0, fmi3False, 0.0)); }
    void exit_initialization() { check(fmi3ExitInitializationMode(instance)); }
    void step(double time, double length) {
        fmi3Boolean event = fmi3False, end = fmi3False, early = fmi3False;
        fmi3Float64 reached = 0.0;
        check(fmi3DoStep(instance, time, length, fmi3True, &event, &end, &early, &reached));
    }
};

/* The truck speeds up to 15 m/s in 10 s; the drone stays 100 m above it. */
static void set_motion(Tether &tether, double time) {
    const double speed = 1.5 * std::fmin(time, 10.0), way = time < 10.0 ? 0.75 * time * time : 15.0 * (time - 5.0);
    tether.set("ground_position", {way, 0.0, 0.0});
    tether.set("ground_velocity", {speed, 0.0, 0.0});
    tether.set("kite_position", {way, 0.0, 100.0});
    tether.set("kite_velocity", {speed, 0.0, 0.0});
}

static void fly(const std::string &folder) {
    Tether tether(folder);
    tether.enter_initialization();
    tether.set("initial_length", {110.0});
    tether.set("wind_velocity", {-6.0, 0.0, 0.0}); /* against the truck, at the height of 10 m */
    tether.choose("wind_profile", 2);              /* power_law */
    tether.set("wind_reference_height", {10.0});
    tether.set("wind_exponent", {0.14});
    set_motion(tether, 0.0);
    tether.exit_initialization();
    const double step = 0.02;
    for (int k = 0; k < 1000; k++) {
        set_motion(tether, step * k); /* the inputs belong to the start of the step, the outputs to its end */
        tether.step(step * k, step);
        const Vector f = tether.get("kite_force");
        if (k % 200 == 199) std::printf("%4.1f s: %.3f N\n", step * (k + 1), std::hypot(f[0], f[1], f[2]));
    }
}

int main(int count, char **arguments) {
    try {
        if (count != 2) throw std::runtime_error("give the folder of an extracted TetherDynamic.fmu");
        fly(arguments[1]);
    } catch (const std::exception &problem) {
        std::fprintf(stderr, "fly_from_cpp: %s\n", problem.what());
        return 1;
    }
}
