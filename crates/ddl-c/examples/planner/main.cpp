// A sampling planner (MPPI): ten times a second the tracks of simulated people, their joint futures, the risk of
// 2,000 plans (or the number given) around the last one, and the mean of the plans by what they cost. The robot
// crosses a corridor where people walk both ways.
#include <ddl.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

namespace {

constexpr double tick = 0.1, step = 0.4, radius = 0.3, fastest = 1.4;
constexpr int steps = 12;
constexpr ddl::Point goal = {5.0, 8.0};

using Velocities = std::vector<ddl::Point>;  // of each step, m/s

// Person i of eight: four walk east along y = 2 to 3.5, four west along y = 4 to 5.5, with a sway.
ddl::Observation person(int i, double time) {
    const double direction = i % 2 ? -1.0 : 1.0, speed = 1.1 + 0.05 * i, crossing = 1.5 + 0.6 * i;
    const double lane = (direction > 0 ? 2.0 : 4.0) + 0.25 * i;
    return {i, {5.0 + direction * speed * (time - crossing), lane + 0.05 * std::sin(2.0 * time + i)}};
}

ddl::Plan plan_of(ddl::Point at, const Velocities& velocities) {
    ddl::Plan plan = {{0.0, at, radius}};
    for (int s = 0; s < steps; ++s) {
        at = {at.x + step * velocities[s].x, at.y + step * velocities[s].y};
        plan.push_back({step * (s + 1), at, radius});
    }
    return plan;
}

// The velocities of one rollout: noise that lasts, around the nominal ones.
Velocities rollout(const Velocities& nominal, std::mt19937& random) {
    std::normal_distribution<double> noise(0.0, 0.25);
    Velocities velocities = nominal;
    ddl::Point shift = {noise(random), noise(random)};
    for (ddl::Point& v : velocities) {
        shift = {0.8 * shift.x + noise(random), 0.8 * shift.y + noise(random)};
        v = {v.x + shift.x, v.y + shift.y};
        const double speed = std::hypot(v.x, v.y), kept = std::min(1.0, fastest / std::max(speed, 1e-9));
        v = {kept * v.x, kept * v.y};
    }
    return velocities;
}

// A collision costs most, then every second away from the goal; changes of velocity cost a little.
double cost(double risk, const ddl::Plan& plan, const Velocities& velocities) {
    double sum = 20.0 * risk;
    for (const auto& row : plan) sum += 0.1 * std::hypot(goal.x - row.position.x, goal.y - row.position.y);
    for (int s = 1; s < steps; ++s) {
        sum += 0.1 * std::hypot(velocities[s].x - velocities[s - 1].x, velocities[s].y - velocities[s - 1].y);
    }
    return sum;
}

}  // namespace

int main(int count, char** words) try {
    const int rollouts = count > 1 ? std::clamp(std::atoi(words[1]), 1, 100000) : 2000;
    ddl::Model model("world");
    ddl::Live live(model);
    ddl::Forecast forecast;
    std::mt19937 random(0);
    ddl::Point robot = {5.0, 0.0};
    Velocities nominal(steps, {0.0, 1.0});
    double closest = INFINITY;
    int ticks = 0;
    for (; ticks < 200 && std::hypot(goal.x - robot.x, goal.y - robot.y) > 0.5; ++ticks) {
        const double now = tick * ticks;
        std::vector<ddl::Observation> seen;
        for (int i = 0; i < 8; ++i) seen.push_back(person(i, now));
        for (const auto& one : seen) {
            closest = std::min(closest, std::hypot(one.position.x - robot.x, one.position.y - robot.y));
        }
        live.observe(now, seen, forecast, ddl::joint());
        if (forecast.pedestrians() == 0) continue;  // nobody is there

        // The last plan, a tick later.
        for (int s = 0; s + 1 < steps; ++s) {
            const ddl::Point change = {nominal[s + 1].x - nominal[s].x, nominal[s + 1].y - nominal[s].y};
            nominal[s] = {nominal[s].x + tick / step * change.x, nominal[s].y + tick / step * change.y};
        }
        std::vector<Velocities> sampled(rollouts, nominal);  // the first is the last plan itself
        for (int r = 1; r < rollouts; ++r) sampled[r] = rollout(nominal, random);
        std::vector<ddl::Plan> plans;
        for (const Velocities& velocities : sampled) plans.push_back(plan_of(robot, velocities));
        const std::vector<ddl::Risk> risks = forecast.risks(plans);
        std::vector<double> costs;
        for (int r = 0; r < rollouts; ++r) costs.push_back(cost(risks[r].total, plans[r], sampled[r]));

        const double least = *std::min_element(costs.begin(), costs.end());
        Velocities mean(steps, {0.0, 0.0});
        double total = 0.0;
        for (int r = 0; r < rollouts; ++r) {
            const double weight = std::exp((least - costs[r]) / 0.2);
            total += weight;
            for (int s = 0; s < steps; ++s) {
                mean[s] = {mean[s].x + weight * sampled[r][s].x, mean[s].y + weight * sampled[r][s].y};
            }
        }
        for (int s = 0; s < steps; ++s) nominal[s] = {mean[s].x / total, mean[s].y / total};
        robot = {robot.x + tick * nominal[0].x, robot.y + tick * nominal[0].y};
        if (ticks % 10 == 1) {
            std::printf("%4.1f s  robot (%.1f, %.1f)  %.2f m/s  risk %.2f\n", now, robot.x, robot.y,
                        std::hypot(nominal[0].x, nominal[0].y), forecast.risks({plan_of(robot, nominal)})[0].total);
        }
    }
    std::printf("at (%.1f, %.1f) after %.1f s, %.2f m from somebody at the closest\n", robot.x, robot.y, tick * ticks,
                closest);
    return ticks == 200 || closest < radius;
} catch (const ddl::Error& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
}
