//! The state of an unfinished training in one file, checked when read and written atomically.

use crate::StarError;
use crate::model::Parameters;
use crate::training::optimizer::Adam;
use ddl_network::NetworkError;
use ddl_network::weights::{Origin, StoredTensor, TensorData, find_tensor, read_tensors, write_tensors};
use std::path::Path;
use tch::{Device, Kind, Tensor};

const WEIGHTS: &str = "parameters";
const FIRST_MOMENT: &str = "first_moment";
const SECOND_MOMENT: &str = "second_moment";
const PROGRESS: &str = "progress";

/// Vectors of the size of the weights, with their names.
type NamedVectors<'a> = [(&'static str, &'a Tensor)];

#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct TrainerProgress {
    /// Batches seen, over all epochs.
    pub(crate) steps: u64,
    /// Sum of the loss over the batches of the running epoch.
    pub(crate) loss_sum: f64,
    /// Seconds spent in the running epoch.
    pub(crate) seconds: f64,
}

/// Writes everything that a killed run needs to continue into one file, so that its parts always match: also `vectors`,
/// and the counters `progress` of the training, of which the first is the number of steps.
pub(crate) fn save(
    parameters: &Parameters,
    adam: &Adam,
    progress: &[f64],
    vectors: &NamedVectors<'_>,
    origin: &Origin,
    path: &Path,
) -> Result<(), StarError> {
    let state = [(WEIGHTS, &parameters.flat), (FIRST_MOMENT, &adam.first_moment), (SECOND_MOMENT, &adam.second_moment)];
    let mut tensors =
        state.iter().chain(vectors).map(|(name, tensor)| stored(name, tensor)).collect::<Result<Vec<_>, _>>()?;
    tensors.push(StoredTensor {
        name: PROGRESS.to_owned(),
        shape: vec![progress.len()],
        numbers: TensorData::Double(progress.to_vec()),
    });
    Ok(write_tensors(&tensors, origin, path)?)
}

/// Restores the state and returns the number of steps and the N counters of the training; changes nothing if the file
/// is not complete.
pub(crate) fn load<const N: usize>(
    parameters: &Parameters,
    adam: &mut Adam,
    vectors: &NamedVectors<'_>,
    most_steps: u64,
    origin: &Origin,
    path: &Path,
) -> Result<(u64, [f64; N]), StarError> {
    let count = 3 + vectors.len() as u64;
    let tensors = read_tensors(path, parameters.layout().count() as u64 * count * 8, origin)?;
    let find = |name: &str| -> Result<Tensor, StarError> {
        let stored = find_tensor(&tensors, name, path)?;
        let shape = [parameters.layout().count()];
        Ok(match parameters.flat.kind() {
            Kind::Double => Tensor::f_from_slice(&stored.double(&shape, path)?)?,
            _ => Tensor::f_from_slice(&stored.single(&shape, path)?)?,
        })
    };
    let (weights, first, second) = (find(WEIGHTS)?, find(FIRST_MOMENT)?, find(SECOND_MOMENT)?);
    let others = vectors.iter().map(|(name, _)| find(name)).collect::<Result<Vec<_>, _>>()?;
    // Adam divides by the root of its second moment, so a negative value would give NaN.
    if second.lt(0.0).any().int64_value(&[]) != 0 {
        let problem = format!("{SECOND_MOMENT} holds negative numbers; delete it and run the same training again");
        return Err(NetworkError::checkpoint(path, problem).into());
    }
    let found = find_tensor(&tensors, PROGRESS, path)?.double(&[N], path)?;
    let mut progress = [0.0; N];
    progress.copy_from_slice(&found);
    let steps = whole_steps(progress[0], most_steps, path)?;
    let _guard = tch::no_grad_guard();
    parameters.flat.shallow_clone().f_copy_(&weights)?;
    adam.first_moment.f_copy_(&first)?;
    adam.second_moment.f_copy_(&second)?;
    adam.steps = steps;
    for ((_, vector), stored) in vectors.iter().zip(others) {
        vector.shallow_clone().f_copy_(&stored)?;
    }
    Ok((steps, progress))
}

fn whole_steps(number: f64, most: u64, path: &Path) -> Result<u64, StarError> {
    if number.fract() == 0.0 && (0.0..=most as f64).contains(&number) {
        return Ok(number as u64);
    }
    let problem = format!(
        "the step count is {number}, not a whole number in 0..={most}; delete it and run the same training again"
    );
    Err(NetworkError::checkpoint(path, problem).into())
}

fn stored(name: &str, tensor: &Tensor) -> Result<StoredTensor, StarError> {
    let here = tensor.detach().f_to_device(Device::Cpu)?.f_reshape([-1])?;
    Ok(StoredTensor {
        name: name.to_owned(),
        shape: vec![here.numel()],
        numbers: match here.kind() {
            Kind::Double => TensorData::Double(Vec::try_from(here)?),
            _ => TensorData::Single(Vec::try_from(here)?),
        },
    })
}
