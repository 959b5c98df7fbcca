// The C++ interface of ddl: owners of the handles of ddl.h, and exceptions. C++17, header only.
//
//   ddl::Model model("world");                  // throws ddl::Error, as everything here does
//   ddl::Live live(model);                      // times in seconds
//   ddl::Forecast forecast;                     // keeps its memory from frame to frame
//   live.observe(time, {{7, {1.0, 2.5}}}, forecast, ddl::joint());
//   for (std::size_t i = 0; i < forecast.pedestrians(); ++i) use(forecast.id(i), forecast.path(i, 0));
//
// Arrays are those of the handle: valid until the next call of the same kind. Shapes and units: ddl.h.

#ifndef DDL_HPP
#define DDL_HPP

#include "ddl.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace ddl {

using Point = ddl_point;
using Observation = ddl_observation;
using PlanPoint = ddl_plan_point;
/// Rows of time, position and radius, in the order of time.
using Plan = std::vector<PlanPoint>;

/// Steps of a forecast, and of an observation, 0.4 s apart.
inline constexpr std::size_t horizon = 12, observed = 8;

/// What a call of the library failed for; `what()` says what is wrong, where, and what to do.
class Error : public std::runtime_error {
public:
    explicit Error(ddl_status status) : std::runtime_error(ddl_last_error()), status_(status) {}
    ddl_status status() const noexcept { return status_; }

private:
    ddl_status status_;
};

namespace detail {
inline void check(ddl_status status) {
    if (status != DDL_STATUS_OK) throw Error(status);
}
template <typename Handle, void (*release)(Handle*)>
struct Release {
    void operator()(Handle* handle) const noexcept { release(handle); }
};
template <typename Handle, void (*release)(Handle*)>
using Owner = std::unique_ptr<Handle, Release<Handle, release>>;
inline ddl_plan rows(const Plan& plan) { return {plan.data(), plan.size()}; }
}  // namespace detail

/// Values of the library that follow each other in memory.
template <typename T>
class Array {
public:
    Array(const T* first, std::size_t size) : first_(first), size_(first ? size : 0) {}
    const T* begin() const noexcept { return first_; }
    const T* end() const noexcept { return first_ + size_; }
    const T* data() const noexcept { return first_; }
    std::size_t size() const noexcept { return size_; }
    bool empty() const noexcept { return size_ == 0; }
    const T& operator[](std::size_t index) const noexcept { return first_[index]; }

private:
    const T* first_;
    std::size_t size_;
};

/// Takes so many bytes from the system now, so that later calls need not: 24 MB are enough for 25 pedestrians.
inline void reserve(std::size_t bytes) { detail::check(ddl_reserve(bytes)); }

/// A trained model; any number of threads may use it at the same time.
class Model {
public:
    /// "world" is built in; otherwise a packed model or the folder of a run. One thread: the one that calls.
    explicit Model(const std::string& name = "world", std::size_t threads = 1) {
        ddl_model* model = nullptr;
        detail::check(ddl_model_open(name.c_str(), threads, &model));
        handle_.reset(model);
    }
    const ddl_model* get() const noexcept { return handle_.get(); }

private:
    detail::Owner<ddl_model, ddl_model_free> handle_;
};

/// What is forecast: the hypotheses of each pedestrian alone, if nothing is set.
struct Request {
    bool joint = false;
    Plan plan{};
    std::optional<std::int64_t> ego{};

    ddl_request get() const {
        return {joint, plan.empty() ? ddl_plan{nullptr, 0} : detail::rows(plan), ego ? &*ego : nullptr};
    }
};

/// Futures of the whole scene, which respond to a plan if there is one.
inline Request joint(Plan plan = {}, std::optional<std::int64_t> ego = {}) {
    return {true, std::move(plan), ego};
}

struct Risk {
    /// Probability that anybody comes close.
    double total;
    /// `[N]`, `[12]`, `[12]`: that this pedestrian does; that somebody is close in this step; was by its end.
    Array<double> of_each, steps, until;
    const char* warning; ///< What is doubtful of the plans; null if nothing is.
};

struct Cells {
    double cell = 0.1;
    double every = 0.4;
    double radius = 0.2;
    double margin = 1.0;
    std::optional<std::pair<Point, Point>> corners{};
};

/// A forecast, in memory that the next one uses again. One thread at a time.
class Forecast {
public:
    Forecast() : handle_(ddl_forecast_new()) {}

    std::size_t pedestrians() const noexcept { return view().pedestrians; }
    std::size_t hypotheses() const noexcept { return view().hypotheses; }
    /// Whether it is of the last frame; false where no forecast was due (`LiveOptions::every`).
    bool due() const noexcept { return view().due; }
    std::int64_t id(std::size_t i) const noexcept { return view().ids[i]; }
    Array<Point> past(std::size_t i) const noexcept { return {view().past + i * observed, observed}; }
    /// 12 positions of hypothesis k of pedestrian i.
    Array<Point> path(std::size_t i, std::size_t k) const noexcept {
        return {view().paths + pair(i, k) * horizon, horizon};
    }
    double weight(std::size_t i, std::size_t k) const noexcept { return view().weights[pair(i, k)]; }
    /// The hypothesis of the largest weight.
    std::size_t most_likely(std::size_t i) const noexcept {
        std::size_t best = 0;
        for (std::size_t k = 1; k < hypotheses(); ++k) {
            if (weight(i, k) > weight(i, best)) best = k;
        }
        return best;
    }
    /// Everything, as ddl.h has it.
    const ddl_view& view() const noexcept { return *ddl_forecast_view(handle_.get()); }

    /// `[N][K][12]`: radii of the discs of the regions of this probability; NaN where there is none.
    Array<double> radii(double level) {
        const double* radii = nullptr;
        detail::check(ddl_forecast_radii(handle_.get(), level, &radii));
        return {radii, pedestrians() * hypotheses() * horizon};
    }

    /// The risk of each plan, of joint futures: that somebody comes within so many metres of its edge.
    std::vector<Risk> risks(const std::vector<Plan>& plans, double within = 0.5,
                            std::optional<std::int64_t> ego = {}, bool unseen = false) {
        std::vector<ddl_plan> rows;
        rows.reserve(plans.size());
        for (const Plan& plan : plans) rows.push_back(detail::rows(plan));
        const ddl_risks* risks = nullptr;
        detail::check(ddl_forecast_risks(handle_.get(), rows.data(), rows.size(), within, ego ? &*ego : nullptr,
                                         unseen, &risks));
        std::vector<Risk> answers;
        answers.reserve(risks->plans);
        for (std::size_t p = 0; p < risks->plans; ++p) {
            answers.push_back({risks->total[p],
                               {risks->of_each + p * risks->pedestrians, risks->pedestrians},
                               {risks->steps + p * horizon, horizon},
                               {risks->until + p * horizon, horizon},
                               risks->warning});
        }
        return answers;
    }

    /// Grids of the probability that a cell is occupied, of joint futures.
    const ddl_occupancy& occupancy(const Cells& cells = {}) {
        Point corners[2] = {};
        if (cells.corners) {
            corners[0] = cells.corners->first;
            corners[1] = cells.corners->second;
        }
        const ddl_cells wanted = {cells.cell, cells.every, cells.radius, cells.corners ? &corners : nullptr,
                                  cells.margin};
        const ddl_occupancy* occupancy = nullptr;
        detail::check(ddl_forecast_occupancy(handle_.get(), &wanted, &occupancy));
        return *occupancy;
    }

    ddl_forecast* get() noexcept { return handle_.get(); }

private:
    std::size_t pair(std::size_t i, std::size_t k) const noexcept { return i * hypotheses() + k; }
    detail::Owner<ddl_forecast, ddl_forecast_free> handle_;
};

/// Forecasts pedestrians from `[N][8]` positions, 0.4 s apart, the present last.
inline void forecast(const Model& model, const std::vector<Point>& past, Forecast& forecast,
                     const Request& request = {}) {
    if (past.size() % observed != 0) throw std::invalid_argument("past must have 8 positions for each pedestrian");
    const ddl_request wanted = request.get();
    detail::check(ddl_model_forecast(model.get(), past.data(), past.size() / observed, &wanted, forecast.get()));
}

struct LiveOptions {
    /// Frames per second, if frames are numbered; 0 if they have times in seconds.
    double rate = 0.0;
    /// The file of the memory of the place; empty without one.
    std::string memory{};
    /// Only pedestrians tracked for all 8 steps.
    bool whole = false;
    /// For so long (s) a pedestrian without a new row is carried on.
    std::optional<double> max_age{};
    /// Seconds between two forecasts; 0 for one at every frame. Between them the last one stays (`due`).
    double every = 0.0;
};

/// The tracks of one place. Calls of several threads wait for each other.
class Live {
public:
    explicit Live(const Model& model, const LiveOptions& options = {}) {
        const ddl_live_options wanted = {options.rate, options.memory.empty() ? nullptr : options.memory.c_str(),
                                         options.whole, options.max_age ? &*options.max_age : nullptr,
                                         options.every};
        ddl_live* live = nullptr;
        detail::check(ddl_live_new(model.get(), &wanted, &live));
        handle_.reset(live);
    }

    /// Adds a frame with all pedestrians that are seen, and forecasts. After an exception the tracks are unchanged.
    void observe(double at, const std::vector<Observation>& observations, Forecast& forecast,
                 const Request& request = {}) {
        const ddl_request wanted = request.get();
        detail::check(ddl_live_observe(handle_.get(), at, observations.data(), observations.size(), &wanted,
                                       forecast.get()));
    }

    /// Forgets all tracks, as when a tracker restarts.
    void clear() { detail::check(ddl_live_clear(handle_.get())); }

    /// Writes the memory of the place; the destructor does not.
    void close() { detail::check(ddl_live_close(handle_.get())); }

private:
    detail::Owner<ddl_live, ddl_live_free> handle_;
};

}  // namespace ddl

#endif  // DDL_HPP
