// What ddl.h and ddl.hpp promise, on the installed library.
#include <ddl.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>
#include <thread>
#include <vector>

// Where there is a leak sanitizer: what the present thread takes from now on is no leak.
extern "C" void __lsan_disable() __attribute__((weak));

namespace {

#define REQUIRE(condition)                                                            \
    do {                                                                              \
        if (!(condition)) {                                                           \
            std::fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition);      \
            std::exit(1);                                                             \
        }                                                                             \
    } while (false)

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Two people who meet, with 8 positions each.
std::vector<ddl::Point> meeting() {
    std::vector<ddl::Point> past;
    for (int t = 0; t < 8; ++t) past.push_back({0.5 * t, 0.0});
    for (int t = 0; t < 8; ++t) past.push_back({9.0 - 0.5 * t, 0.8});
    return past;
}

std::vector<ddl::Observation> meeting_at(double t) {
    return {{1, {0.5 * t, 0.0}}, {0, {9.0 - 0.5 * t, 0.8}}};
}

template <typename Call>
std::string error_of(Call call, ddl_status status = DDL_STATUS_INVALID) {
    try {
        call();
    } catch (const ddl::Error& error) {
        REQUIRE(error.status() == status);
        return error.what();
    }
    std::fprintf(stderr, "no error where one was expected\n");
    std::abort();
}

double distance(ddl::Point a, ddl::Point b) { return std::hypot(a.x - b.x, a.y - b.y); }

bool has(const std::string& text, const char* words) { return text.find(words) != std::string::npos; }

void forecasts_are_whole(const ddl::Model& model) {
    ddl::Forecast forecast;
    ddl::forecast(model, meeting(), forecast);
    REQUIRE(forecast.pedestrians() == 2 && forecast.hypotheses() == 20);
    const ddl_view& view = forecast.view();
    for (std::size_t i = 0; i < 2; ++i) {
        double sum = 0.0;
        for (std::size_t k = 0; k < 20; ++k) {
            sum += forecast.weight(i, k);
            REQUIRE(view.certified[i * 20 + k]);
            // The certificate says that the goal comes nearer at every step.
            const auto path = forecast.path(i, k);
            double left = distance(forecast.past(i)[7], view.goals[i * 20 + k]);
            for (const ddl::Point& position : path) {
                const double next = distance(position, view.goals[i * 20 + k]);
                REQUIRE(next < left || next == 0.0);
                left = next;
            }
        }
        REQUIRE(std::abs(sum - 1.0) < 1e-9);
        REQUIRE(view.familiarity[i] > 0.0 && view.familiarity[i] <= 1.0);
        REQUIRE(view.age[i] == 0.0 && view.uncertainty[i] >= 0.0);
    }
    REQUIRE(forecast.path(0, forecast.most_likely(0))[11].x > 3.5);
    const auto radii = forecast.radii(0.9);
    REQUIRE(radii.size() == 2 * 20 * 12);
    REQUIRE(std::count_if(radii.begin(), radii.end(), [](double radius) { return radius > 0.0; }) > 0);
    REQUIRE(has(error_of([&] { forecast.radii(2.0); }), "level is 2"));
    REQUIRE(has(error_of([&] { forecast.risks({{{0.0, {0.0, 0.0}, 0.3}}}); }), "joint"));
}

void scenes_answer_plans(const ddl::Model& model) {
    ddl::Forecast forecast;
    ddl::forecast(model, meeting(), forecast, ddl::joint());
    for (std::size_t k = 0; k < 20; ++k) REQUIRE(forecast.weight(0, k) == forecast.weight(1, k));
    const ddl::Plan between = {{0.0, {4.5, -1.0}, 0.3}, {4.8, {4.5, 2.0}, 0.3}};
    const ddl::Plan aside = {{0.0, {4.5, 30.0}, 0.3}, {4.8, {4.5, 33.0}, 0.3}};
    const auto risks = forecast.risks({between, aside});
    const auto unseen = forecast.risks({between}, 0.5, {}, true);
    REQUIRE(risks.size() == 2 && risks[0].total > risks[1].total && risks[1].total < 0.01);
    REQUIRE(unseen.at(0).of_each.size() == 2 && unseen[0].total <= 1.0);
    REQUIRE(std::is_sorted(unseen[0].until.begin(), unseen[0].until.end()));
    REQUIRE(unseen[0].until[11] == unseen[0].total);

    ddl::Cells cells;
    cells.cell = 0.25;
    cells.corners = {{-1.0, -2.0}, {10.0, 3.0}};
    const ddl_occupancy& grids = forecast.occupancy(cells);
    REQUIRE(grids.times == 13 && grids.width == 44 && grids.height == 20 && grids.cell == 0.25);
    // The first pedestrian stands in (3.5, 0) now: the cell (18, 8) begins there.
    REQUIRE(grids.probabilities[8 * 44 + 18] > 0.999F && grids.probabilities[0] == 0.0F);
    REQUIRE(grids.time[12] > 4.79 && grids.origin.x == -1.0);
    const std::vector<float> before(grids.probabilities, grids.probabilities + 13 * 44 * 20);
    cells.every = 0.01;
    cells.cell = 0.01;
    REQUIRE(has(error_of([&] { forecast.occupancy(cells); }), "fewer times"));
    cells.cell = 0.25;
    cells.radius = -1.0;
    REQUIRE(has(error_of([&] { forecast.occupancy(cells); }), "the radius of a body is -1"));
    cells.cell = 0.0;
    REQUIRE(has(error_of([&] { forecast.occupancy(cells); }), "the size of a cell is 0"));
    REQUIRE(std::equal(before.begin(), before.end(), grids.probabilities));

    // Who follows the plan does so in every future.
    ddl::Forecast given;
    ddl::forecast(model, meeting(), given, ddl::joint({{0.0, {3.5, 0.0}, 0.2}, {4.8, {3.5, 4.8}, 0.2}}, 0));
    for (std::size_t k = 0; k < 20; ++k) REQUIRE(std::abs(given.path(0, k)[11].y - 4.8) < 1e-9);
    REQUIRE(has(error_of([&] { given.risks({between}, 0.5, 77); }), "already keep away from the plan"));
    REQUIRE(has(error_of([&] { given.risks({between}, 0.5, 77, true); }), "ego is 77"));
}

void wrong_input_is_told(const ddl::Model& model) {
    REQUIRE(has(error_of([] { ddl::Model("no/such.model"); }, DDL_STATUS_FILE), "no/such.model"));
    ddl::Forecast forecast;
    REQUIRE(has(error_of([&] { ddl::forecast(model, {}, forecast); }), "pedestrian"));
    const ddl::Plan standing = {{0.0, {0.0, 0.0}, 0.3}};
    auto wrong = meeting();
    wrong[3].x = nan;
    REQUIRE(has(error_of([&] { ddl::forecast(model, wrong, forecast); }), "NaN"));
    // As in a stream: nobody is so fast, and who was beside the track once is told.
    auto fast = meeting();
    for (std::size_t t = 0; t < 8; ++t) fast[t].x = 4e5 * static_cast<double>(t);
    ddl::forecast(model, fast, forecast);
    REQUIRE(forecast.view().pedestrians == 1 && forecast.view().ids[0] == 1 && forecast.view().misfit_count > 0);
    for (std::size_t t = 8; t < 16; ++t) fast[t].x = fast[t - 8].x;
    REQUIRE(has(error_of([&] { ddl::forecast(model, fast, forecast); }), "no pedestrian can be forecast: "));
    auto aside = meeting();
    aside[3].x += 30.0;
    ddl::forecast(model, aside, forecast);
    REQUIRE(forecast.view().pedestrians == 2 && forecast.view().misfit_count == 1);
    REQUIRE(forecast.view().misfits[0].id == 0 && forecast.view().warning == nullptr);
    // Plans in centimetres, and a radius that no forecast sees.
    const ddl::Plan centimetres = {{0.0, {0.0, 0.0}, 0.3}, {4.8, {200.0, 0.0}, 0.3}};
    ddl::forecast(model, meeting(), forecast, ddl::joint(centimetres));
    REQUIRE(has(forecast.view().warning, "centimetres"));
    ddl::forecast(model, meeting(), forecast, ddl::joint());
    const ddl::Plan late = {{0.0, {0.0, 0.0}, 0.3}, {60.0, {0.0, 0.0}, 5.0}};
    REQUIRE(forecast.view().warning == nullptr);
    REQUIRE(has(forecast.risks({standing, late})[0].warning, "plan 1 has the radius 5 m"));
    REQUIRE(forecast.risks({standing})[0].warning == nullptr);
    REQUIRE(has(error_of([&] { ddl::forecast(model, meeting(), forecast, ddl::joint({{9.0, {0.0, 0.0}, 0.3}})); }),
                "the plan is from 9 s"));
    ddl::Request alone = ddl::joint({{0.0, {0.0, 0.0}, 0.3}});
    alone.joint = false;
    REQUIRE(has(error_of([&] { ddl::forecast(model, meeting(), forecast, alone); }), "set joint"));
    for (const auto& [plan, words] : {std::pair{standing, "ego is 77"}, {ddl::Plan{}, "ego follows a plan"}})
        REQUIRE(has(error_of([&] { ddl::forecast(model, meeting(), forecast, ddl::joint(plan, 77)); }), words));
    ddl::LiveOptions options;
    options.max_age = 3.0;
    REQUIRE(has(error_of([&] { ddl::Live(model, options); }), "`max_age` is 3"));
    options = {};
    options.rate = -1.0;
    REQUIRE(has(error_of([&] { ddl::Live(model, options); }), "`rate` is -1"));

    ddl::Live live(model);
    live.observe(1.0, meeting_at(0), forecast);
    for (const double moment : {1.0, 0.5, nan, 1e300}) {
        error_of([&] { live.observe(moment, meeting_at(1), forecast); });
    }
    const ddl::Observation twice[] = {{1, {0.0, 0.0}}, {1, {1.0, 0.0}}};
    REQUIRE(has(error_of([&] { live.observe(1.4, {twice[0], twice[1]}, forecast); }), "at 1.4 s"));
    live.observe(1.4, meeting_at(1), forecast);
    REQUIRE(forecast.pedestrians() == 2);

    ddl_model* none = nullptr;
    const ddl_risks* risks = nullptr;
    REQUIRE(ddl_model_open(nullptr, 1, &none) == DDL_STATUS_INVALID && has(ddl_last_error(), "name is null"));
    REQUIRE(ddl_model_open("world", 1, nullptr) == DDL_STATUS_INVALID);
    REQUIRE(ddl_model_open("\xff", 1, &none) == DDL_STATUS_INVALID && has(ddl_last_error(), "UTF-8"));
    REQUIRE(ddl_model_forecast(model.get(), nullptr, 2, nullptr, forecast.get()) == DDL_STATUS_INVALID);
    const auto past = meeting();
    REQUIRE(ddl_model_forecast(model.get(), past.data(), SIZE_MAX / 2, nullptr, forecast.get()) ==
            DDL_STATUS_INVALID);
    REQUIRE(ddl_model_forecast(nullptr, past.data(), 2, nullptr, forecast.get()) == DDL_STATUS_INVALID);
    REQUIRE(ddl_live_observe(nullptr, 0.0, nullptr, 0, nullptr, forecast.get()) == DDL_STATUS_INVALID);
    REQUIRE(ddl_forecast_risks(forecast.get(), nullptr, 1, 0.5, nullptr, false, &risks) == DDL_STATUS_INVALID);
    const ddl_plan empty = {nullptr, 3};
    REQUIRE(ddl_forecast_risks(forecast.get(), &empty, 1, 0.5, nullptr, false, &risks) == DDL_STATUS_INVALID);
    REQUIRE(ddl_forecast_occupancy(forecast.get(), nullptr, nullptr) == DDL_STATUS_INVALID);
    REQUIRE(ddl_forecast_view(nullptr) == nullptr && ddl_live_close(nullptr) == DDL_STATUS_INVALID);
    REQUIRE(ddl_reserve(SIZE_MAX) == DDL_STATUS_INVALID && ddl_reserve(0) == DDL_STATUS_OK);
    ddl_model_free(nullptr);
    ddl_live_free(nullptr);
    ddl_forecast_free(nullptr);
}

void a_place_is_remembered(const ddl::Model& model) {
    const std::string file = "contract.memory";
    std::remove(file.c_str());
    ddl::LiveOptions options;
    options.rate = 2.5;
    options.memory = file;
    for (int session = 0; session < 2; ++session) {
        ddl::Live live(model, options);
        REQUIRE(has(error_of([&] { ddl::Live(model, options); }, DDL_STATUS_FILE), "contract.memory"));
        ddl::Forecast forecast;
        for (int t = 0; t < 30; ++t) live.observe(t, meeting_at(t), forecast);
        REQUIRE(has(error_of([&] { live.observe(30.5, meeting_at(30), forecast); }), "with `rate` a frame number"));
        REQUIRE(forecast.view().remembered > 0 && forecast.view().warning == nullptr);
        live.clear();
        live.observe(0, {}, forecast);
        REQUIRE(forecast.pedestrians() == 0 && forecast.view().ids == nullptr);
        REQUIRE(forecast.radii(0.9).data() == nullptr);
        live.close();
    }
    std::remove(file.c_str());
    std::remove((file + ".lock").c_str());
}

// Ten frames a second, and a forecast every 0.4 s.
void a_forecast_stays_until_the_next(const ddl::Model& model) {
    ddl::LiveOptions options;
    options.every = 0.4;
    ddl::Live live(model, options);
    ddl::Forecast forecast;
    ddl::Point last = {};
    for (int tick = 0; tick < 40; ++tick) {
        live.observe(0.1 * tick, meeting_at(0.25 * tick), forecast, ddl::joint());
        REQUIRE(forecast.due() == (tick % 4 == 0));
        REQUIRE(forecast.pedestrians() == 2);
        const ddl::Point end = forecast.path(0, 0)[11];
        REQUIRE((distance(end, last) == 0.0) != forecast.due());
        last = end;
        REQUIRE(forecast.risks({{{0.0, last, 0.3}}}).size() == 1);
    }
    live.observe(8.0, {}, forecast);
    REQUIRE(forecast.due() && forecast.pedestrians() == 0);
}

// Threads share a model, each with tracks of its own; threads of the model change nothing.
void threads_agree() {
    std::vector<ddl::Model> models;
    models.emplace_back("world", 1);
    models.emplace_back("world", 2);
    std::vector<std::vector<ddl::Point>> paths(4);
    std::vector<std::thread> threads;
    for (std::size_t thread = 0; thread < 4; ++thread) {
        threads.emplace_back([&, thread] {
            // A thread that calls takes some kB for good.
            if (__lsan_disable) __lsan_disable();
            ddl::Live live(models[thread % 2]);
            ddl::Forecast forecast;
            for (int t = 0; t < 10; ++t) live.observe(0.4 * t, meeting_at(t), forecast, ddl::joint());
            const auto all = forecast.view().paths;
            paths[thread].assign(all, all + 2 * 20 * 12);
        });
    }
    for (std::thread& thread : threads) thread.join();
    const auto bytes = [](const std::vector<ddl::Point>& path) { return path.size() * sizeof(ddl::Point); };
    for (const auto& path : paths) {
        REQUIRE(path.size() == 480 && std::memcmp(path.data(), paths[0].data(), bytes(path)) == 0);
    }
}

}  // namespace

int main() {
    REQUIRE(std::string(ddl_version()).size() >= 5 && std::string(ddl_last_error()).empty());
    const ddl::Model model;
    forecasts_are_whole(model);
    scenes_answer_plans(model);
    wrong_input_is_told(model);
    a_place_is_remembered(model);
    a_forecast_stays_until_the_next(model);
    threads_agree();
    std::puts("contract kept");
}
