// A planner's loop: ten times a second the tracks of simulated people, their joint futures, the risk of a few candidate
// plans, and the choice of one. The robot crosses a corridor where people walk both ways.
#include <ddl.hpp>

#include <cmath>
#include <cstdio>
#include <vector>

namespace {

// Person i of eight: four walk east along y = 2 to 3.5, four west along y = 4 to 5.5, with a sway.
ddl::Observation person(int i, double time) {
    const double direction = i % 2 ? -1.0 : 1.0, speed = 1.1 + 0.05 * i, crossing = 1.5 + 0.6 * i;
    const double lane = (direction > 0 ? 2.0 : 4.0) + 0.25 * i;
    return {i, {5.0 + direction * speed * (time - crossing), lane + 0.05 * std::sin(2.0 * time + i)}};
}

// From `at` to the far side, at this speed and slant, for 4.8 s.
ddl::Plan straight(ddl::Point at, double speed, double slant) {
    const double radius = 0.3, end = 4.8;
    return {{0.0, at, radius}, {end, {at.x + end * slant, at.y + end * speed}, radius}};
}

}  // namespace

int main() try {
    const double speeds[] = {1.2, 1.2, 1.2, 0.6, 0.0}, slants[] = {0.0, -0.5, 0.5, 0.0, 0.0};
    const char* names[] = {"ahead", "left", "right", "slowly", "wait"};

    ddl::Model model("world");
    ddl::Live live(model);
    ddl::Forecast forecast;
    ddl::Point robot = {5.0, 0.0};
    for (int tick = 0; tick < 120 && robot.y < 7.0; ++tick) {
        const double now = 0.1 * tick;
        std::vector<ddl::Observation> seen;
        for (int i = 0; i < 8; ++i) seen.push_back(person(i, now));
        live.observe(now, seen, forecast, ddl::joint());
        if (forecast.pedestrians() == 0) continue;  // nobody is there

        std::vector<ddl::Plan> plans;
        for (int p = 0; p < 5; ++p) plans.push_back(straight(robot, speeds[p], slants[p]));
        const std::vector<ddl::Risk> risks = forecast.risks(plans);
        // Progress is worth something, a collision costs much; who waits loses nothing but time.
        const auto cost = [&](int p) { return 5.0 * risks[p].total - speeds[p] + 0.2 * std::abs(slants[p]); };
        int best = 0;
        for (int p = 1; p < 5; ++p) {
            if (cost(p) < cost(best)) best = p;
        }
        robot.x += 0.1 * slants[best];
        robot.y += 0.1 * speeds[best];
        if (tick % 10 == 1) {
            std::printf("%4.1f s  robot (%.1f, %.1f)  ", now, robot.x, robot.y);
            for (int p = 0; p < 5; ++p) std::printf("%s %.2f  ", names[p], risks[p].total);
            std::printf("-> %s\n", names[best]);
        }
    }
    std::printf("arrived at (%.1f, %.1f)\n", robot.x, robot.y);
    return robot.y < 7.0;
} catch (const ddl::Error& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
}
