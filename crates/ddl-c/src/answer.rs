//! A forecast, and what is computed from it, in arrays that are filled again and again.

use crate::boundary::{CallFailure, c_text};
use crate::layout::{ddl_cells, ddl_misfit, ddl_occupancy, ddl_point, ddl_risks, ddl_view};
use crate::model::Threads;
use ddl::data::{HORIZON, Misfit, OBSERVED, ObservationQuality, Window};
use ddl::scene::{Area, Futures, Occupancy, Plan, SceneError};
use ddl::{Answer, Forecast, Note};
use std::ffi::CString;
use std::ptr;
use std::sync::Arc;

#[derive(Debug, Default)]
pub(crate) struct ShownAnswer {
    held: Option<Held>,
    ids: Vec<i64>,
    numbers: Packed,
    certified: Vec<bool>,
    misfits: Vec<ddl_misfit>,
    warning: CString,
    pub(crate) view: ddl_view,
    radii: Vec<f64>,
    risk_numbers: Packed,
    pub(crate) risks: ddl_risks,
    doubts: CString,
    times: Vec<f64>,
    probabilities: Vec<f32>,
    pub(crate) occupancy: ddl_occupancy,
}

#[derive(Debug)]
pub(crate) struct Held {
    pub(crate) window: Window,
    pub(crate) answer: Answer,
    pub(crate) threads: Arc<Threads>,
}

/// What a live frame says besides its forecast.
#[derive(Debug, Default)]
pub(crate) struct LiveNotes {
    pub(crate) misfits: Vec<Misfit>,
    pub(crate) remembered: usize,
    pub(crate) warning: Option<String>,
}

/// What there is to warn of, besides misfits and refused memories, which are shown at every frame.
pub(crate) fn warning_of(notes: &[Note]) -> Option<String> {
    let told = notes.iter().filter(|note| !matches!(note, Note::Misfits { .. } | Note::MemoryRefused { .. }));
    told.map(Note::to_string).reduce(|all, one| all + "; " + &one)
}

/// Arrays of numbers, one after the other.
#[derive(Debug, Default)]
struct Packed {
    numbers: Vec<f64>,
    starts: Vec<usize>,
}

impl Packed {
    fn clear(&mut self) {
        self.numbers.clear();
        self.starts.clear();
    }

    fn add(&mut self, numbers: impl IntoIterator<Item = f64>) {
        self.starts.push(self.numbers.len());
        self.numbers.extend(numbers);
    }

    /// The addresses of the arrays; null for one without numbers.
    fn arrays<const N: usize>(&self) -> [*const f64; N] {
        let start = |array: usize| self.starts.get(array).copied().unwrap_or(self.numbers.len());
        std::array::from_fn(|array| address(&self.numbers[start(array)..start(array + 1)]))
    }
}

impl ShownAnswer {
    /// Replaces the stored forecast by a new one; `None` if no pedestrian can be forecast.
    pub(crate) fn hold(&mut self, held: Option<Held>, notes: &LiveNotes) {
        self.ids.clear();
        self.certified.clear();
        self.numbers.clear();
        if let Some(Held { window, answer, .. }) = &held {
            self.fill(window, answer.forecast());
        }
        let [past, age, uncertainty, paths, weights, goals, familiarity, spread] = self.numbers.arrays();
        self.view = ddl_view {
            pedestrians: self.ids.len(),
            hypotheses: held.as_ref().map_or(0, |held| held.answer.forecast().hypotheses()),
            ids: address(&self.ids),
            past: past.cast(),
            age,
            uncertainty,
            paths: paths.cast(),
            weights,
            goals: goals.cast(),
            certified: address(&self.certified),
            familiarity,
            spread,
            ..ddl_view::default()
        };
        self.held = held;
        self.keep(notes);
        self.view.due = true;
    }

    /// Leaves the stored forecast as it is, and marks it as older than the last frame.
    pub(crate) fn keep(&mut self, notes: &LiveNotes) {
        self.misfits.clear();
        self.misfits.extend(
            notes.misfits.iter().map(|misfit| ddl_misfit { id: misfit.pedestrian.0, distance: misfit.distance }),
        );
        self.warning = c_text(notes.warning.as_deref().unwrap_or_default());
        self.view.due = false;
        self.view.misfits = address(&self.misfits);
        self.view.misfit_count = self.misfits.len();
        self.view.remembered = notes.remembered;
        self.view.warning = notes.warning.as_ref().map_or(ptr::null(), |_| self.warning.as_ptr());
    }

    fn fill(&mut self, window: &Window, forecast: &Forecast) {
        let qualities = || (0..window.len()).map(|i| window.quality(i));
        let past = (0..window.len()).flat_map(|i| &window.observed(i)[..OBSERVED]);
        let paths = pairs(forecast).flat_map(|(i, k)| forecast.hypothesis(i, k));
        self.ids.extend(window.pedestrians().iter().map(|id| id.0));
        self.numbers.add(past.copied().flatten());
        self.numbers.add(qualities().map(|quality| quality.age));
        self.numbers.add(qualities().map(ObservationQuality::uncertainty));
        self.numbers.add(paths.copied().flatten());
        self.numbers.add(pairs(forecast).map(|(i, k)| forecast.weight(i, k)));
        self.numbers.add(pairs(forecast).filter_map(|(i, k)| forecast.goal(i, k)).flatten());
        self.numbers.add((0..window.len()).filter_map(|i| forecast.familiarity(i)));
        self.numbers.add((0..window.len()).flat_map(|i| (0..HORIZON).filter_map(move |t| forecast.scale(i, t))));
        self.certified.extend(pairs(forecast).filter_map(|(i, k)| forecast.certified(i, k)));
    }

    /// Radii `[N][K][12]` of the discs around the hypotheses in the region of a level; NaN where there is none.
    pub(crate) fn compute_radii(&mut self, level: f64) -> Result<*const f64, CallFailure> {
        let Some(held) = &self.held else {
            return Ok(ptr::null());
        };
        let forecast = held.answer.forecast();
        let none = || CallFailure::invalid("the hypotheses of this model have no weights, and so no regions");
        let [low, high] = forecast.regions().ok_or_else(none)?.range();
        if !(low..=high).contains(&level) {
            return Err(CallFailure::invalid(format!(
                "level is {level}; it must be a probability from {low} to {high}"
            )));
        }
        let steps = pairs(forecast).flat_map(|(i, k)| (0..HORIZON).map(move |t| (i, k, t)));
        let radius = |(i, k, t)| forecast.region_radius(i, k, t, level).unwrap_or(f64::NAN);
        self.radii.clear();
        self.radii.extend(steps.map(radius));
        Ok(address(&self.radii))
    }

    /// The risk of each plan, which pedestrians see or not.
    pub(crate) fn compute_risks(
        &mut self,
        plans: &[Plan],
        within: f64,
        ego: Option<i64>,
        seen: bool,
    ) -> Result<(), CallFailure> {
        let (held, futures) = joint(self.held.as_ref())?;
        if seen && futures.plan().is_some() {
            return Err(CallFailure::invalid(SceneError::PlanGiven));
        }
        let index = |id| {
            let index = held.window.pedestrians().iter().position(|known| known.0 == id);
            index.ok_or_else(|| CallFailure::invalid(format!("ego is {id}, but no such pedestrian is forecast")))
        };
        let ego = ego.map(index).transpose()?;
        let doubts = warning_of(&Note::of_plans((0..).zip(plans), futures, ego));
        let risks = held.threads.run(|| {
            let risks = if seen { Futures::risks_if_seen } else { Futures::risks };
            risks(futures, plans, within, ego).map_err(CallFailure::invalid)
        })?;
        let numbers = &mut self.risk_numbers;
        numbers.clear();
        numbers.add(risks.iter().map(|risk| risk.total));
        numbers.add(risks.iter().flat_map(|risk| &risk.pedestrians).copied());
        numbers.add(risks.iter().flat_map(|risk| risk.steps));
        numbers.add(risks.iter().flat_map(|risk| risk.until));
        let [total, of_each, steps, until] = numbers.arrays();
        let (plans, pedestrians) = (plans.len(), futures.pedestrians());
        self.doubts = c_text(doubts.as_deref().unwrap_or_default());
        let warning = doubts.map_or(ptr::null(), |_| self.doubts.as_ptr());
        self.risks = ddl_risks { plans, pedestrians, total, of_each, steps, until, warning };
        Ok(())
    }

    /// Grids of the probability that a cell is occupied.
    pub(crate) fn compute_occupancy(&mut self, cells: &ddl_cells<'_>) -> Result<(), CallFailure> {
        let (held, futures) = joint(self.held.as_ref())?;
        let threads = Arc::clone(&held.threads);
        let times = Occupancy::every(cells.every).map_err(CallFailure::invalid)?;
        let area = match cells.corners {
            Some(corners) => {
                let [low, high] = corners.map(|corner| [corner.x, corner.y]);
                Area::new(low, high, cells.cell).map(|area| (area, Vec::new()))
            }
            None => futures.area(cells.margin, cells.cell, times.len()),
        };
        let (area, left_out) = area.map_err(CallFailure::invalid)?;
        let [width, height] = area.size();
        area.ensure_kept(times.len()).map_err(CallFailure::invalid)?;
        threads.run(|| {
            let grids = futures.occupancy(&area, &times, cells.radius).map_err(CallFailure::invalid)?;
            // After an error the last grids are still there.
            self.probabilities.clear();
            self.probabilities.extend(grids.flat_map(|grid| grid.probabilities));
            Ok(())
        })?;
        self.times = times;
        let [x, y] = area.origin();
        self.occupancy = ddl_occupancy {
            times: self.times.len(),
            width,
            height,
            origin: ddl_point { x, y },
            cell: area.cell(),
            outside: left_out.len(),
            time: address(&self.times),
            probabilities: address(&self.probabilities),
        };
        Ok(())
    }
}

fn joint(held: Option<&Held>) -> Result<(&Held, &Futures), CallFailure> {
    let joint = held.and_then(|held| Some((held, held.answer.futures().ok()?)));
    joint.ok_or_else(|| {
        CallFailure::invalid("risk and occupancy need a forecast of somebody, with joint set in its request")
    })
}

fn pairs(forecast: &Forecast) -> impl Iterator<Item = (usize, usize)> + use<> {
    let hypotheses = forecast.hypotheses();
    (0..forecast.pedestrians() * hypotheses).map(move |pair| (pair / hypotheses, pair % hypotheses))
}

fn address<T>(values: &[T]) -> *const T {
    if values.is_empty() { ptr::null() } else { values.as_ptr() }
}
