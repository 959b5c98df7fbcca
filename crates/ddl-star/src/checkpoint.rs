//! Weights and training state as safetensors files: checked when read, atomic when written.

use crate::StarError;
use crate::numbers_digest::{check_numbers, numbers_digest};
use crate::optimizer::Adam;
use crate::origin::Origin;
use crate::parameters::Parameters;
use safetensors::SafeTensors;
use safetensors::tensor::{Dtype, TensorView};
use std::io::{Read as _, Write as _};
use std::path::Path;
use tch::{Kind, Tensor};

/// Room for the header of a safetensors file beyond its numbers.
const HEADER_BYTES: u64 = 1 << 20;

const WEIGHTS: &str = "parameters";
const FIRST_MOMENT: &str = "first_moment";
const SECOND_MOMENT: &str = "second_moment";
const PROGRESS: &str = "progress";

/// Writes the learned tensors, by name, and what they are of.
///
/// # Errors
/// [`StarError::Io`] or [`StarError::Torch`] when the file cannot be written; an existing file is
/// then left as it was.
pub fn save_parameters(
    parameters: &Parameters,
    origin: &Origin,
    path: &Path,
) -> Result<(), StarError> {
    let tensors: Vec<(String, Tensor)> = parameters
        .iter()
        .map(|(name, tensor)| (name.to_owned(), plain(tensor)))
        .collect();
    write(&tensors, origin, path)
}

/// Reads the learned tensors into a network's parameters.
///
/// # Errors
/// [`StarError::Checkpoint`] when the file is truncated, too large, of another origin, or holds other
/// names, shapes or numbers than the network needs; the parameters are then unchanged.
pub fn load_parameters(
    parameters: &Parameters,
    origin: &Origin,
    path: &Path,
) -> Result<(), StarError> {
    let tensors = read(path, parameters.count() as u64 * 8, origin)?;
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
    origin: &Origin,
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
    write(&tensors, origin, path)
}

pub(crate) fn load_training(
    parameters: &Parameters,
    adam: &mut Adam,
    most_steps: u64,
    origin: &Origin,
    path: &Path,
) -> Result<Progress, StarError> {
    let tensors = read(path, parameters.count() as u64 * 3 * 8, origin)?;
    let (size, kind) = (parameters.flat().size(), parameters.flat().kind());
    let weights = find(&tensors, WEIGHTS, &size, kind, path)?;
    let first = find(&tensors, FIRST_MOMENT, &size, kind, path)?;
    let second = find(&tensors, SECOND_MOMENT, &size, kind, path)?;
    require_squares(second, path)?;
    let numbers: Vec<f64> = Vec::try_from(find(&tensors, PROGRESS, &[3], Kind::Double, path)?)?;
    let steps = whole_steps(numbers[0], most_steps, path)?;
    let _guard = tch::no_grad_guard();
    parameters.flat().shallow_clone().f_copy_(weights)?;
    adam.first_moment.f_copy_(first)?;
    adam.second_moment.f_copy_(second)?;
    adam.set_steps(steps);
    Ok(Progress {
        steps,
        loss_sum: numbers[1],
        seconds: numbers[2],
    })
}

/// Adam divides by the root of its second moment: a negative one would turn weights into NaN.
pub(crate) fn require_squares(second_moment: &Tensor, path: &Path) -> Result<(), StarError> {
    if second_moment.lt(0.0).any().int64_value(&[]) == 0 {
        return Ok(());
    }
    let problem = format!(
        "{SECOND_MOMENT} holds negative numbers; delete it and run the same training again"
    );
    Err(bad(path, problem))
}

/// A number of steps as the file holds it.
pub(crate) fn whole_steps(number: f64, most: u64, path: &Path) -> Result<u64, StarError> {
    if number.fract() == 0.0 && (0.0..=most as f64).contains(&number) {
        return Ok(number as u64);
    }
    let problem = format!(
        "the step count is {number}, not a whole number in 0..={most}; delete it and run the same training again"
    );
    Err(bad(path, problem))
}

/// The tensor on the CPU, contiguous and without gradient.
pub(crate) fn plain(tensor: &Tensor) -> Tensor {
    tensor.detach().to_device(tch::Device::Cpu).contiguous()
}

pub(crate) fn write(
    tensors: &[(String, Tensor)],
    origin: &Origin,
    path: &Path,
) -> Result<(), StarError> {
    let io = |source| StarError::Io {
        path: path.to_owned(),
        source,
    };
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let numbers = tensors
        .iter()
        .map(|(name, tensor)| Ok((name, Numbers::of(tensor, path)?)))
        .collect::<Result<Vec<_>, StarError>>()?;
    let broken = |error: safetensors::SafeTensorError| bad(path, error.to_string());
    let views = numbers
        .iter()
        .map(|(name, numbers)| Ok((name.as_str(), numbers.view()?)))
        .collect::<Result<Vec<_>, _>>()
        .map_err(broken)?;
    let header = origin.to_header(&numbers_digest(views.iter().cloned()));
    let bytes = safetensors::serialize(views, Some(header)).map_err(broken)?;
    let mut builder = tempfile::Builder::new();
    let builder = builder.prefix(".writing-").suffix(".safetensors");
    // Temporary files are private by default; results are as readable as the user's other files.
    #[cfg(unix)]
    let builder = builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut temporary = builder.tempfile_in(folder).map_err(io)?;
    temporary.write_all(&bytes).map_err(io)?;
    temporary.as_file().sync_all().map_err(io)?;
    temporary.persist(path).map_err(|error| io(error.error))?;
    Ok(())
}

/// A tensor as the file holds it.
struct Numbers {
    kind: Dtype,
    shape: Vec<usize>,
    bytes: Vec<u8>,
}

impl Numbers {
    fn of(tensor: &Tensor, path: &Path) -> Result<Self, StarError> {
        let kind = match tensor.kind() {
            Kind::Float => Dtype::F32,
            Kind::Double => Dtype::F64,
            other => return Err(bad(path, format!("cannot hold numbers of kind {other:?}"))),
        };
        let count = tensor.numel();
        let mut bytes = vec![0; count * tensor.kind().elt_size_in_bytes()];
        tensor.f_copy_data_u8(&mut bytes, count)?;
        let shape = tensor.size().iter().map(|&size| size as usize).collect();
        Ok(Self { kind, shape, bytes })
    }

    fn view(&self) -> Result<TensorView<'_>, safetensors::SafeTensorError> {
        TensorView::new(self.kind, self.shape.clone(), &self.bytes)
    }
}

/// The tensors of a file of at most `most_bytes`, which has to be of this origin.
pub(crate) fn read(
    path: &Path,
    most_bytes: u64,
    origin: &Origin,
) -> Result<Vec<(String, Tensor)>, StarError> {
    let io = |source| StarError::Io {
        path: path.to_owned(),
        source,
    };
    // The size first: nothing is read, and no room made, for what cannot be a checkpoint.
    let size = std::fs::metadata(path).map_err(io)?.len();
    if size > most_bytes + HEADER_BYTES {
        return Err(bad(
            path,
            format!("is {size} bytes long, a checkpoint of this network at most {most_bytes}"),
        ));
    }
    let mut bytes = Vec::new();
    // What is no plain file may have more to say than its size.
    let file = std::fs::File::open(path).map_err(io)?;
    let most = most_bytes + HEADER_BYTES;
    file.take(most).read_to_end(&mut bytes).map_err(io)?;
    let broken = |error: safetensors::SafeTensorError| {
        let problem = format!(
            "is not a whole safetensors file ({error}); delete it and run the same training again"
        );
        bad(path, problem)
    };
    let (_, header) = SafeTensors::read_metadata(&bytes).map_err(broken)?;
    let (of_file, digest) = Origin::of_header(header.metadata().as_ref());
    if let Some(difference) = of_file.difference(origin) {
        let problem = format!(
            "belongs to another run than the config.json beside it: its {difference}; put back the file, or the \
             config.json, that it was made with"
        );
        return Err(bad(path, problem));
    }
    let file = SafeTensors::deserialize(&bytes).map_err(broken)?;
    check_numbers(&file, digest.as_deref()).map_err(|error| bad(path, error.to_string()))?;
    file.iter()
        .map(|(name, view)| {
            let kind = match view.dtype() {
                Dtype::F32 => Kind::Float,
                Dtype::F64 => Kind::Double,
                other => {
                    let problem = format!("{name} holds {other:?}, expected 32- or 64-bit floats");
                    return Err(bad(path, problem));
                }
            };
            let shape: Vec<i64> = view.shape().iter().map(|&size| size as i64).collect();
            let tensor = Tensor::f_from_data_size(view.data(), &shape, kind)?;
            Ok((name.to_owned(), tensor))
        })
        .collect()
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
