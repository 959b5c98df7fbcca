//! Tests of training, across crates and of the program `ddl`, which need libtorch.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod agreement;
#[cfg(unix)]
mod faults;
mod from_training;
mod golden_forecasts;
mod own_training;
mod train_resume;

#[cfg(unix)]
#[test]
fn the_page_about_training() {
    ddl_tests::guide::check("docs/training.md");
}

#[test]
fn readers_of_trainings_handle_edited_files() {
    ddl_tests::outside_bytes::TORCH_READERS.into_iter().for_each(ddl_tests::outside_bytes::check);
}
