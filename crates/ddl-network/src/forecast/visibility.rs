//! Who sees whom.

use ddl_data::Window;

/// Whether pedestrian i sees pedestrian j: for each of the first `steps` time steps, for each window, `[size, size]`.
pub fn visibility<'a>(
    windows: impl IntoIterator<Item = &'a Window>,
    steps: usize,
    half_box: f64,
) -> Vec<bool> {
    let windows: Vec<&Window> = windows.into_iter().collect();
    let mut visible = Vec::new();
    for t in 0..steps {
        for window in &windows {
            let seen = window.neighbours(t, half_box);
            for i in 0..window.len() {
                visible.extend((0..window.len()).map(|j| i == j || seen.is_neighbour(i, j)));
            }
        }
    }
    visible
}
