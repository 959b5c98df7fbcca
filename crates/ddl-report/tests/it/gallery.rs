//! The selection of moments of a fold.

use ddl_data::{Dataset, WindowRule};
use ddl_eval::Protocol;
use ddl_eval::baseline::ConstantVelocity;
use ddl_report::gallery;

#[test]
fn moments_cover_the_time_of_a_fold_and_few_windows_are_all_shown() {
    let windows = Dataset::simulated(1).fold("corridor").unwrap().test_windows(WindowRule::Complete);
    let forecasts = Protocol::Fair.forecast(&ConstantVelocity::LastStep, &windows).unwrap();
    let moments = gallery::moments("corridor", "CV", &windows, &forecasts).unwrap();
    assert_eq!(moments.len(), 8);
    // In order of time, from the first to the last eighth of the recording.
    let frames: Vec<i64> = moments.iter().map(|m| m.frame).collect();
    assert!(frames.is_sorted());
    let present: Vec<i64> = windows.iter().map(|w| w.frames()[7]).collect();
    let (first, last) = (present[present.len() / 8], present[7 * present.len() / 8]);
    assert!(frames[0] <= first && frames[frames.len() - 1] >= last);
    let few = gallery::moments("corridor", "CV", &windows[..3], &forecasts[..3]).unwrap();
    assert_eq!(few.len(), 3);
    assert_eq!(gallery::moments("corridor", "CV", &[], &[]).unwrap(), []);
    assert!(gallery::moments("corridor", "CV", &windows[..3], &forecasts).is_err());
    assert!(gallery::moments("c", "CV", &[windows[0].without_future()], &forecasts[..1]).is_err());
}
