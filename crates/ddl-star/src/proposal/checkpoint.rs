//! The state of a training under way, as one file.

use crate::StarError;
use crate::checkpoint::{find, plain, read, require_squares, whole_steps, write};
use crate::optimizer::Adam;
use crate::origin::Origin;
use crate::parameters::Parameters;
use std::path::Path;
use tch::{Kind, Tensor};

const TENSORS: [&str; 4] = ["parameters", "average", "first_moment", "second_moment"];
const PROGRESS: &str = "progress";

/// How far a training has come.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Progress {
    pub(super) steps: u64,
    pub(super) distance: f64,
}

pub(super) fn save(
    parameters: &Parameters,
    average: &Tensor,
    adam: &Adam,
    progress: Progress,
    origin: &Origin,
    path: &Path,
) -> Result<(), StarError> {
    let all = [
        parameters.flat(),
        average,
        &adam.first_moment,
        &adam.second_moment,
    ];
    let mut tensors: Vec<(String, Tensor)> = TENSORS
        .iter()
        .zip(all)
        .map(|(name, tensor)| ((*name).to_owned(), plain(tensor)))
        .collect();
    let numbers = Tensor::from_slice(&[progress.steps as f64, progress.distance]);
    tensors.push((PROGRESS.to_owned(), numbers));
    write(&tensors, origin, path)
}

/// Restores all of it; nothing is changed when the file is not whole.
pub(super) fn load(
    parameters: &Parameters,
    average: &mut Tensor,
    adam: &mut Adam,
    most_steps: u64,
    origin: &Origin,
    path: &Path,
) -> Result<Progress, StarError> {
    let most_bytes = parameters.count() as u64 * TENSORS.len() as u64 * 8;
    let tensors = read(path, most_bytes, origin)?;
    let (size, kind) = (parameters.flat().size(), parameters.flat().kind());
    let stored = TENSORS
        .iter()
        .map(|name| find(&tensors, name, &size, kind, path))
        .collect::<Result<Vec<_>, _>>()?;
    require_squares(stored[3], path)?;
    let numbers: Vec<f64> = Vec::try_from(find(&tensors, PROGRESS, &[2], Kind::Double, path)?)?;
    let steps = whole_steps(numbers[0], most_steps, path)?;
    let _guard = tch::no_grad_guard();
    parameters.flat().shallow_clone().f_copy_(stored[0])?;
    average.f_copy_(stored[1])?;
    adam.first_moment.f_copy_(stored[2])?;
    adam.second_moment.f_copy_(stored[3])?;
    adam.set_steps(steps);
    Ok(Progress {
        steps,
        distance: numbers[1],
    })
}
