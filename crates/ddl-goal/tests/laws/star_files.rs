//! The real recordings, and goal errors on them.

use std::collections::BTreeMap;

use ddl_data::{Convention, DataError, Dataset, Window, locate};
use ddl_goal::GoalSet;

pub(crate) fn dataset() -> Result<Dataset, DataError> {
    Dataset::load(Convention::Star, &locate(Convention::Star, None)?)
}

/// The 20 positions (m) of pedestrians, by start frame and pedestrian.
pub(crate) type StarWindows = BTreeMap<(i64, i64), Vec<[f64; 2]>>;

pub(crate) fn tracks_of<'a>(windows: impl IntoIterator<Item = &'a Window>) -> StarWindows {
    let tracks = |window: &'a Window| {
        let pedestrians = window.pedestrians().iter().enumerate();
        pedestrians.map(|(i, id)| ((window.start_frame(), id.0), window.track(i).to_vec()))
    };
    windows.into_iter().flat_map(tracks).collect()
}

/// Distance from the true endpoint to the nearest goal (m).
pub(crate) fn goal_error(goals: &GoalSet, track: &[[f64; 2]]) -> f64 {
    let goal = goals.goals()[goals.nearest(track[19])];
    (goal[0] - track[19][0]).hypot(goal[1] - track[19][1])
}
