//! Weights and other tensors as safetensors files: checked when read, atomic when written.

use super::digest::{check_numbers, numbers_digest};
use super::layout::Layout;
use super::learned::Weights;
use super::origin::Origin;
use crate::NetworkError;
use ddl_data::write_whole;
use safetensors::SafeTensors;
use safetensors::tensor::{Dtype, TensorView};
use std::io::Read as _;
use std::path::Path;
use std::sync::Arc;

/// Room for the header of a safetensors file beyond its numbers.
const HEADER_BYTES: u64 = 1 << 20;

/// A tensor of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredTensor {
    /// Its name.
    pub name: String,
    /// Its shape; numbers lie row by row.
    pub shape: Vec<usize>,
    /// Its numbers.
    pub numbers: StoredNumbers,
}

/// The numbers of a [`StoredTensor`], in the precision that the file has them in.
#[derive(Debug, Clone, PartialEq)]
pub enum StoredNumbers {
    /// 32-bit floats.
    Single(Vec<f32>),
    /// 64-bit floats.
    Double(Vec<f64>),
}

impl StoredTensor {
    /// The tensor in single precision.
    ///
    /// # Errors
    /// [`NetworkError::Checkpoint`], naming `path`, when its shape is another one or a number is not finite.
    pub fn single(&self, shape: &[usize], path: &Path) -> Result<Vec<f32>, NetworkError> {
        // In the precision it will have: a large f64 is infinite in f32.
        let numbers = match &self.numbers {
            StoredNumbers::Single(numbers) => numbers.clone(),
            StoredNumbers::Double(numbers) => numbers.iter().map(|&number| number as f32).collect(),
        };
        self.checked(shape, numbers.iter().all(|number| number.is_finite()), path)?;
        Ok(numbers)
    }

    /// The tensor in double precision.
    ///
    /// # Errors
    /// As [`single`](Self::single).
    pub fn double(&self, shape: &[usize], path: &Path) -> Result<Vec<f64>, NetworkError> {
        let numbers: Vec<f64> = match &self.numbers {
            StoredNumbers::Single(numbers) => numbers.iter().map(|&number| number.into()).collect(),
            StoredNumbers::Double(numbers) => numbers.clone(),
        };
        self.checked(shape, numbers.iter().all(|number| number.is_finite()), path)?;
        Ok(numbers)
    }

    fn checked(&self, shape: &[usize], is_finite: bool, path: &Path) -> Result<(), NetworkError> {
        let name = &self.name;
        if self.shape != shape {
            let problem = format!("{name} has shape {:?}, expected {shape:?}", self.shape);
            return Err(NetworkError::checkpoint(path, problem));
        }
        if !is_finite {
            let problem = format!("{name} holds NaN or infinite numbers");
            return Err(NetworkError::checkpoint(path, problem));
        }
        Ok(())
    }

    fn bytes(&self) -> (Dtype, Vec<u8>) {
        match &self.numbers {
            StoredNumbers::Single(numbers) => {
                let bytes = numbers.iter().flat_map(|number| number.to_le_bytes());
                (Dtype::F32, bytes.collect())
            }
            StoredNumbers::Double(numbers) => {
                let bytes = numbers.iter().flat_map(|number| number.to_le_bytes());
                (Dtype::F64, bytes.collect())
            }
        }
    }
}

/// Writes learned tensors, by name, and what they are of.
///
/// # Errors
/// [`NetworkError::Io`] when the file cannot be written; an existing file is then left as it was.
pub fn save_weights(weights: &Weights, origin: &Origin, path: &Path) -> Result<(), NetworkError> {
    let tensors: Vec<StoredTensor> = weights
        .iter()
        .map(|(tensor, numbers)| StoredTensor {
            name: tensor.name().to_owned(),
            shape: tensor.shape().to_vec(),
            numbers: StoredNumbers::Single(numbers.to_vec()),
        })
        .collect();
    write_tensors(&tensors, origin, path)
}

/// Reads learned tensors of that layout.
///
/// # Errors
/// [`NetworkError::Checkpoint`] when the file is truncated, too large, of another origin, or holds other
/// names, shapes or numbers than the network needs.
pub fn load_weights(
    layout: &Arc<Layout>,
    origin: &Origin,
    path: &Path,
) -> Result<Weights, NetworkError> {
    let stored = read_tensors(path, layout.count() as u64 * 8, origin)?;
    let (found, wanted) = (stored.len(), layout.tensors().len());
    if found != wanted {
        let problem = format!(
            "holds {found} tensors, this network has {wanted}; it was written for another configuration"
        );
        return Err(NetworkError::checkpoint(path, problem));
    }
    let mut numbers = Vec::with_capacity(layout.count());
    for tensor in layout.tensors() {
        let one = find_tensor(&stored, tensor.name(), path)?;
        numbers.extend(one.single(tensor.shape(), path)?);
    }
    Ok(Weights::new(Arc::clone(layout), numbers))
}

/// The tensor of that name.
///
/// # Errors
/// [`NetworkError::Checkpoint`], naming `path`, when there is none.
pub fn find_tensor<'a>(
    tensors: &'a [StoredTensor],
    name: &str,
    path: &Path,
) -> Result<&'a StoredTensor, NetworkError> {
    let mut tensors = tensors.iter();
    tensors
        .find(|tensor| tensor.name == name)
        .ok_or_else(|| NetworkError::checkpoint(path, format!("lacks the tensor {name}")))
}

/// Writes tensors, and what they are of, with the SHA-256 of their numbers.
///
/// # Errors
/// [`NetworkError::Io`] when the file cannot be written; an existing file is then left as it was.
pub fn write_tensors(
    tensors: &[StoredTensor],
    origin: &Origin,
    path: &Path,
) -> Result<(), NetworkError> {
    let parts: Vec<_> = tensors.iter().map(StoredTensor::bytes).collect();
    let broken =
        |error: safetensors::SafeTensorError| NetworkError::checkpoint(path, error.to_string());
    let views = tensors
        .iter()
        .zip(&parts)
        .map(|(tensor, (kind, bytes))| {
            let view = TensorView::new(*kind, tensor.shape.clone(), bytes)?;
            Ok((tensor.name.as_str(), view))
        })
        .collect::<Result<Vec<_>, _>>()
        .map_err(broken)?;
    let header = origin.to_header(&numbers_digest(views.iter().cloned()));
    let bytes = safetensors::serialize(views, Some(header)).map_err(broken)?;
    write_whole(path, &bytes).map_err(NetworkError::io(path))
}

/// The tensors of a file with at most `most_bytes` of numbers, which has to be of this origin.
///
/// # Errors
/// [`NetworkError::Checkpoint`] when the file is truncated, too large, damaged or of another origin, or holds other numbers than
/// 32- and 64-bit floats.
pub fn read_tensors(
    path: &Path,
    most_bytes: u64,
    origin: &Origin,
) -> Result<Vec<StoredTensor>, NetworkError> {
    let io = NetworkError::io(path);
    let bad = |problem: String| NetworkError::checkpoint(path, problem);
    // The size first: nothing is read, and no room made, for what cannot be a checkpoint.
    let size = std::fs::metadata(path).map_err(io)?.len();
    if size > most_bytes + HEADER_BYTES {
        return Err(bad(format!(
            "is {size} bytes long, a checkpoint of this network at most {most_bytes}"
        )));
    }
    let mut bytes = Vec::new();
    // A special file may hold more than the size it reports.
    let file = std::fs::File::open(path).map_err(io)?;
    let most = most_bytes + HEADER_BYTES;
    file.take(most).read_to_end(&mut bytes).map_err(io)?;
    let broken = |error: safetensors::SafeTensorError| {
        bad(format!(
            "is not a whole safetensors file ({error}); delete it and run the same training again"
        ))
    };
    let (_, header) = SafeTensors::read_metadata(&bytes).map_err(broken)?;
    let (of_file, digest) = Origin::of_header(header.metadata().as_ref());
    if let Some(difference) = of_file.difference(origin) {
        return Err(bad(format!(
            "belongs to another run than the config.json beside it: its {difference}; put back the file, or the \
             config.json, that it was made with"
        )));
    }
    let file = SafeTensors::deserialize(&bytes).map_err(broken)?;
    check_numbers(&file, digest.as_deref()).map_err(|error| bad(error.to_string()))?;
    file.iter()
        .map(|(name, view)| {
            let numbers = match view.dtype() {
                Dtype::F32 => {
                    let (numbers, _) = view.data().as_chunks();
                    StoredNumbers::Single(numbers.iter().map(|&b| f32::from_le_bytes(b)).collect())
                }
                Dtype::F64 => {
                    let (numbers, _) = view.data().as_chunks();
                    StoredNumbers::Double(numbers.iter().map(|&b| f64::from_le_bytes(b)).collect())
                }
                other => {
                    return Err(bad(format!(
                        "{name} holds {other:?}, expected 32- or 64-bit floats"
                    )));
                }
            };
            Ok(StoredTensor {
                name: name.to_owned(),
                shape: view.shape().to_vec(),
                numbers,
            })
        })
        .collect()
}
