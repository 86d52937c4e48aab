// A unit sphere rolls by 0.1 rad over a unit sphere and over the paraboloid z = -r^2: Boost odeint's dopri5 integrates
// Montana's contact equations in charts.
//
// Prints one line of JSON per task. The error is the largest difference from the closed form, in any coordinate of the
// contact on either body.
#include <algorithm>
#include <array>
#include <boost/numeric/odeint.hpp>
#include <boost/version.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <vector>

// Latitude and longitude on the probe, the object's two coordinates, and the angle between the charts.
using State = std::array<double, 5>;
using Point = std::array<double, 3>;

constexpr double rate = 0.1, angle = 0.1, direction = 0.7, latitude = 0.3;
constexpr double tolerance = 1e-9;
constexpr int batches = 9;
constexpr double batch_s = 0.02;

struct OverSphere {
    void operator()(const State& at, State& change, double) const {
        const double along = rate / 2, up = -std::sin(at[4]) * along, across = -std::cos(at[4]) * along;
        change = {0, along / std::cos(at[0]), up, across / std::cos(at[2]),
                  -std::tan(at[0]) * along - std::tan(at[2]) * across};
    }
};

struct OverParaboloid {
    void operator()(const State& at, State& change, double) const {
        // p and q: slopes of the object. x1, x2, y2: changes of x and y per unit of velocity along the Gauss frame.
        const double p = -2 * at[2], q = -2 * at[3], square = 1 + p * p;
        const double first = std::sqrt(square), area = std::sqrt(square + q * q);
        const double x1 = 1 / first, x2 = -p * q / (first * area), y2 = first / area;
        // k11, k12, k22: object's curvature in the object's frame. r11, r22, r12: relative curvature in the probe's frame.
        const double bend = 2 / area, k11 = bend * x1 * x1, k12 = bend * x1 * x2, k22 = bend * (x2 * x2 + y2 * y2);
        const double c = std::cos(at[4]), s = std::sin(at[4]);
        const double r11 = k11 * c * c - 2 * k12 * c * s + k22 * s * s + 1;
        const double r22 = k11 * s * s + 2 * k12 * c * s + k22 * c * c + 1;
        const double r12 = (k22 - k11) * c * s - k12 * (c * c - s * s);
        const double determinant = r11 * r22 - r12 * r12;
        const double up = -r12 * rate / determinant, along = r11 * rate / determinant;
        const double b1 = c * up - s * along, b2 = -s * up - c * along, x_rate = x1 * b1 + x2 * b2;
        change = {up, along / std::cos(at[0]), x_rate, y2 * b2,
                  -std::tan(at[0]) * along - 2 * q / (square * area) * x_rate};
    }
};

template <class System>
State roll(const System& system, double start, double first_step) {
    using namespace boost::numeric::odeint;
    State state = {0, 0, start, 0, direction};
    const double end = angle / rate;
    const auto stepper = make_controlled<runge_kutta_dopri5<State>>(tolerance, tolerance);
    integrate_adaptive(stepper, system, state, 0.0, end, first_step * end);
    return state;
}

double largest(const Point& a, const Point& b) {
    double most = 0;
    for (int axis = 0; axis < 3; axis++) most = std::max(most, std::fabs(a[axis] - b[axis]));
    return most;
}

Point on_unit_sphere(double u, double v) { return {std::cos(u) * std::cos(v), -std::cos(u) * std::sin(v), std::sin(u)}; }

double error_over_sphere(const State& at) {
    const double length = angle / 2, s = std::sin(latitude), c = std::cos(latitude);
    const Point radial = {c, 0, s}, tangent = {std::sin(direction) * s, std::cos(direction), -std::sin(direction) * c};
    Point expected;
    for (int axis = 0; axis < 3; axis++) expected[axis] = std::cos(length) * radial[axis] + std::sin(length) * tangent[axis];
    return std::max(largest(on_unit_sphere(at[2], at[3]), expected),
                    largest(on_unit_sphere(at[0], at[1]), on_unit_sphere(0, length)));
}

// Length of the meridian z = -r^2 from the apex to the distance r from the axis.
double meridian(double r) { return r / 2 * std::hypot(1, 2 * r) + std::asinh(2 * r) / 4; }

double error_over_paraboloid(const State& at) {
    // The roll angle is the slope angle plus the length of the meridian divided by the probe's radius, 1.
    double r = angle / 3;
    for (int step = 0; step < 60; step++)
        r -= (std::atan(2 * r) + meridian(r) - angle) / (2 / (1 + 4 * r * r) + std::hypot(1, 2 * r));
    const Point found = {at[2], at[3], -(at[2] * at[2] + at[3] * at[3])};
    const Point expected = {-std::sin(direction) * r, -std::cos(direction) * r, -r * r};
    return std::max(largest(found, expected), largest(on_unit_sphere(at[0], at[1]), on_unit_sphere(0, meridian(r))));
}

// Median over batches of the time of one call, in microseconds.
template <class Job>
double median_us(Job job) {
    using Clock = std::chrono::steady_clock;
    const auto since = [](Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); };
    auto start = Clock::now();
    job();
    const int calls = std::max(1, int(batch_s / since(start)));
    std::vector<double> times;
    for (int batch = 0; batch <= batches; batch++) {
        start = Clock::now();
        for (int call = 0; call < calls; call++) job();
        times.push_back(since(start) / calls * 1e6);
    }
    times.erase(times.begin());
    std::sort(times.begin(), times.end());
    return times[batches / 2];
}

// In such a short roll, the error depends on the size of the first step more than on the tolerance. So measure two sizes.
template <class System, class Error>
void measure(const char* object, const System& system, double start, Error error) {
    for (const double first_step : {1.0, 0.1}) {
        volatile double from = start;
        volatile double kept = 0;
        const double time_us = median_us([&] { kept = roll(system, from, first_step)[4]; });
        std::printf("{\"task\": \"roll 0.1 rad over a %s\", \"peer\": \"Boost odeint dopri5, first step %g\", "
                    "\"version\": \"%d.%d\", \"time_us\": %.6g, \"error\": %.4g}\n",
                    object, first_step, BOOST_VERSION / 100000, BOOST_VERSION / 100 % 1000, time_us,
                    error(roll(system, start, first_step)));
    }
}

int main() {
    measure("sphere", OverSphere{}, latitude, error_over_sphere);
    measure("paraboloid", OverParaboloid{}, 0, error_over_paraboloid);
}
