//! Weights and training state as safetensors files: checked when read, atomic when written.

use crate::StarError;
use crate::optimizer::Adam;
use crate::parameters::Parameters;
use std::path::Path;
use tch::{Kind, Tensor};

/// Room for the header of a safetensors file beyond its numbers.
const HEADER_BYTES: u64 = 1 << 20;

const WEIGHTS: &str = "parameters";
const FIRST_MOMENT: &str = "first_moment";
const SECOND_MOMENT: &str = "second_moment";
const PROGRESS: &str = "progress";

/// Writes the learned tensors, by name.
///
/// # Errors
/// [`StarError::Io`] or [`StarError::Torch`] when the file cannot be written; an existing file is
/// then left as it was.
pub fn save_parameters(parameters: &Parameters, path: &Path) -> Result<(), StarError> {
    let tensors: Vec<(String, Tensor)> = parameters
        .iter()
        .map(|(name, tensor)| (name.to_owned(), plain(tensor)))
        .collect();
    write(&tensors, path)
}

/// Reads the learned tensors into a network's parameters.
///
/// # Errors
/// [`StarError::Checkpoint`] when the file is truncated, too large, or holds other names, shapes or
/// numbers than the network needs; the parameters are then unchanged.
pub fn load_parameters(parameters: &Parameters, path: &Path) -> Result<(), StarError> {
    let tensors = read(path, parameters.count() as u64 * 8)?;
    if tensors.len() != parameters.len() {
        return Err(bad(
            path,
            format!(
                "holds {} tensors, this network has {}; it was written for another configuration",
                tensors.len(),
                parameters.len()
            ),
        ));
    }
    let mut pairs = Vec::new();
    for (name, target) in parameters.iter() {
        let stored = find(&tensors, name, &target.size(), target.kind(), path)?;
        pairs.push((target.shallow_clone(), stored));
    }
    let _guard = tch::no_grad_guard();
    for (mut target, stored) in pairs {
        target.f_copy_(stored)?;
    }
    Ok(())
}

/// How far a training run has come.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Progress {
    /// Batches seen, over all epochs.
    pub(crate) steps: u64,
    /// Sum of the loss over the batches of the running epoch.
    pub(crate) loss_sum: f64,
    /// Seconds spent in the running epoch.
    pub(crate) seconds: f64,
}

/// Writes everything a killed run needs to go on: weights, Adam's moments and the progress, in one
/// file, so that they can never disagree.
pub(crate) fn save_training(
    parameters: &Parameters,
    adam: &Adam,
    progress: Progress,
    path: &Path,
) -> Result<(), StarError> {
    let numbers = Tensor::from_slice(&[progress.steps as f64, progress.loss_sum, progress.seconds]);
    let tensors = [
        (WEIGHTS, plain(parameters.flat())),
        (FIRST_MOMENT, plain(&adam.first_moment)),
        (SECOND_MOMENT, plain(&adam.second_moment)),
        (PROGRESS, numbers),
    ]
    .map(|(name, tensor)| (name.to_owned(), tensor));
    write(&tensors, path)
}

pub(crate) fn load_training(
    parameters: &Parameters,
    adam: &mut Adam,
    path: &Path,
) -> Result<Progress, StarError> {
    let tensors = read(path, parameters.count() as u64 * 3 * 8)?;
    let (size, kind) = (parameters.flat().size(), parameters.flat().kind());
    let weights = find(&tensors, WEIGHTS, &size, kind, path)?;
    let first = find(&tensors, FIRST_MOMENT, &size, kind, path)?;
    let second = find(&tensors, SECOND_MOMENT, &size, kind, path)?;
    let numbers: Vec<f64> = Vec::try_from(find(&tensors, PROGRESS, &[3], Kind::Double, path)?)?;
    let steps = numbers[0];
    if steps < 0.0 || steps.fract() != 0.0 {
        return Err(bad(
            path,
            format!("the step count is {steps}, not a whole number"),
        ));
    }
    let _guard = tch::no_grad_guard();
    parameters.flat().shallow_clone().f_copy_(weights)?;
    adam.first_moment.f_copy_(first)?;
    adam.second_moment.f_copy_(second)?;
    adam.set_steps(steps as u64);
    Ok(Progress {
        steps: steps as u64,
        loss_sum: numbers[1],
        seconds: numbers[2],
    })
}

/// The tensor on the CPU, contiguous and without gradient.
pub(crate) fn plain(tensor: &Tensor) -> Tensor {
    tensor.detach().to_device(tch::Device::Cpu).contiguous()
}

pub(crate) fn write(tensors: &[(String, Tensor)], path: &Path) -> Result<(), StarError> {
    let io = |source| StarError::Io {
        path: path.to_owned(),
        source,
    };
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    let builder = builder.prefix(".writing-").suffix(".safetensors");
    // Temporary files are private by default; results are as readable as the user's other files.
    #[cfg(unix)]
    let builder = builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let temporary = builder.tempfile_in(folder).map_err(io)?;
    Tensor::write_safetensors(tensors, temporary.path())?;
    temporary.as_file().sync_all().map_err(io)?;
    temporary.persist(path).map_err(|error| io(error.error))?;
    Ok(())
}

pub(crate) fn read(path: &Path, most_bytes: u64) -> Result<Vec<(String, Tensor)>, StarError> {
    let size = std::fs::metadata(path)
        .map_err(|source| StarError::Io {
            path: path.to_owned(),
            source,
        })?
        .len();
    if size > most_bytes + HEADER_BYTES {
        return Err(bad(
            path,
            format!("is {size} bytes long, a checkpoint of this network at most {most_bytes}"),
        ));
    }
    Tensor::read_safetensors(path).map_err(|error| {
        bad(
            path,
            format!("is not a whole safetensors file ({error}); delete it and train anew"),
        )
    })
}

pub(crate) fn find<'a>(
    tensors: &'a [(String, Tensor)],
    name: &str,
    shape: &[i64],
    kind: Kind,
    path: &Path,
) -> Result<&'a Tensor, StarError> {
    let (_, tensor) = tensors
        .iter()
        .find(|(candidate, _)| candidate == name)
        .ok_or_else(|| bad(path, format!("lacks the tensor {name}")))?;
    if tensor.size() != shape {
        let problem = format!("{name} has shape {:?}, expected {shape:?}", tensor.size());
        return Err(bad(path, problem));
    }
    if !matches!(tensor.kind(), Kind::Float | Kind::Double) {
        let problem = format!(
            "{name} holds {:?}, expected 32- or 64-bit floats",
            tensor.kind()
        );
        return Err(bad(path, problem));
    }
    // in the precision it will have: a large f64 is infinite in f32
    if tensor.to_kind(kind).isfinite().all().int64_value(&[]) == 0 {
        return Err(bad(path, format!("{name} holds NaN or infinite numbers")));
    }
    Ok(tensor)
}

pub(crate) fn bad(path: &Path, problem: String) -> StarError {
    StarError::Checkpoint {
        path: path.to_owned(),
        problem,
    }
}
