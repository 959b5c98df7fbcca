//! Safetensors files of weights and other tensors. Reading checks them; writing is atomic.

use crate::NetworkError;
use crate::weights::digest::{check_digest, tensors_digest};
use crate::weights::layout::Layout;
use crate::weights::learned::Weights;
use crate::weights::origin::Origin;
use ddl_core::write_atomically;
use safetensors::SafeTensors;
use safetensors::tensor::{Dtype, TensorView};
use std::io::Read as _;
use std::path::Path;
use std::sync::Arc;

/// Largest size of the header of a safetensors file.
const HEADER_BYTES: u64 = 1 << 20;

/// A tensor of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredTensor {
    /// Its name.
    pub name: String,
    /// Its shape.
    pub shape: Vec<usize>,
    /// Its numbers, in row-major order.
    pub numbers: TensorData,
}

/// The numbers of a [`StoredTensor`], in the precision of the file.
#[derive(Debug, Clone, PartialEq)]
pub enum TensorData {
    /// 32-bit floats.
    Single(Vec<f32>),
    /// 64-bit floats.
    Double(Vec<f64>),
}

impl StoredTensor {
    /// The tensor in single precision.
    ///
    /// # Errors
    /// [`NetworkError::Checkpoint`], naming `path`, if the tensor has another shape or a number is not finite.
    pub fn single(&self, shape: &[usize], path: &Path) -> Result<Vec<f32>, NetworkError> {
        // Checked after the conversion, because a large f64 becomes infinite in f32.
        let numbers = match &self.numbers {
            TensorData::Single(numbers) => numbers.clone(),
            TensorData::Double(numbers) => numbers.iter().map(|&number| number as f32).collect(),
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
            TensorData::Single(numbers) => numbers.iter().map(|&number| number.into()).collect(),
            TensorData::Double(numbers) => numbers.clone(),
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
            TensorData::Single(numbers) => {
                let bytes = numbers.iter().flat_map(|number| number.to_le_bytes());
                (Dtype::F32, bytes.collect())
            }
            TensorData::Double(numbers) => {
                let bytes = numbers.iter().flat_map(|number| number.to_le_bytes());
                (Dtype::F64, bytes.collect())
            }
        }
    }
}

/// Writes weights and their origin.
///
/// # Errors
/// [`NetworkError::Io`] if the file cannot be written. An existing file then stays unchanged.
pub fn save_weights(weights: &Weights, origin: &Origin, path: &Path) -> Result<(), NetworkError> {
    let tensors: Vec<StoredTensor> = weights
        .iter()
        .map(|(tensor, numbers)| StoredTensor {
            name: tensor.name().to_owned(),
            shape: tensor.shape().to_vec(),
            numbers: TensorData::Single(numbers.to_vec()),
        })
        .collect();
    write_tensors(&tensors, origin, path)
}

/// Reads the weights of a layout.
///
/// # Errors
/// [`NetworkError::Checkpoint`] if the file is truncated, too large, of another origin, or holds tensors of other
/// names, shapes or types than the network needs.
pub fn load_weights(layout: &Arc<Layout>, origin: &Origin, path: &Path) -> Result<Weights, NetworkError> {
    let stored = read_tensors(path, layout.count() as u64 * 8, origin)?;
    let (count, wanted) = (stored.len(), layout.tensors().len());
    if count != wanted {
        let problem =
            format!("holds {count} tensors, but this network has {wanted}; it was written for another configuration");
        return Err(NetworkError::checkpoint(path, problem));
    }
    let mut numbers = Vec::with_capacity(layout.count());
    for tensor in layout.tensors() {
        let one = find_tensor(&stored, tensor.name(), path)?;
        numbers.extend(one.single(tensor.shape(), path)?);
    }
    Ok(Weights::new(Arc::clone(layout), numbers))
}

/// Finds a tensor by its name.
///
/// # Errors
/// [`NetworkError::Checkpoint`], naming `path`, if there is no tensor of that name.
pub fn find_tensor<'a>(tensors: &'a [StoredTensor], name: &str, path: &Path) -> Result<&'a StoredTensor, NetworkError> {
    let mut tensors = tensors.iter();
    tensors
        .find(|tensor| tensor.name == name)
        .ok_or_else(|| NetworkError::checkpoint(path, format!("has no tensor {name}")))
}

/// Writes tensors, their origin and the SHA-256 of their numbers.
///
/// # Errors
/// [`NetworkError::Checkpoint`] if a tensor has not as many numbers as its shape, [`NetworkError::Io`] if the file
/// cannot be written. An existing file then stays unchanged.
pub fn write_tensors(tensors: &[StoredTensor], origin: &Origin, path: &Path) -> Result<(), NetworkError> {
    let parts: Vec<_> = tensors.iter().map(StoredTensor::bytes).collect();
    let broken = |error: safetensors::SafeTensorError| NetworkError::checkpoint(path, error.to_string());
    let views = tensors
        .iter()
        .zip(&parts)
        .map(|(tensor, (kind, bytes))| {
            let view = TensorView::new(*kind, tensor.shape.clone(), bytes)?;
            Ok((tensor.name.as_str(), view))
        })
        .collect::<Result<Vec<_>, _>>()
        .map_err(broken)?;
    let header = origin.to_header(&tensors_digest(views.iter().cloned()));
    let bytes = safetensors::serialize(views, Some(header)).map_err(broken)?;
    write_atomically(path, &bytes).map_err(NetworkError::io(path))
}

/// Reads the tensors of a file of this origin with at most `most_bytes` bytes of numbers.
///
/// # Errors
/// [`NetworkError::Checkpoint`] if the file is truncated, too large, damaged, of another origin, or holds other types
/// than 32- and 64-bit floats.
pub fn read_tensors(path: &Path, most_bytes: u64, origin: &Origin) -> Result<Vec<StoredTensor>, NetworkError> {
    let io = NetworkError::io(path);
    let bad = |problem: String| NetworkError::checkpoint(path, problem);
    // A file that is too large is refused before it is read and before memory is allocated.
    let size = std::fs::metadata(path).map_err(io)?.len();
    let most = most_bytes.saturating_add(HEADER_BYTES);
    if size > most {
        return Err(bad(format!("is {size} bytes long, but its numbers have at most {most_bytes} bytes")));
    }
    let mut bytes = Vec::new();
    // A special file may hold more than the size it reports.
    let file = std::fs::File::open(path).map_err(io)?;
    file.take(most).read_to_end(&mut bytes).map_err(io)?;
    let broken = |error: safetensors::SafeTensorError| {
        bad(format!("is not a complete safetensors file ({error}); delete it and run the same training again"))
    };
    let (_, header) = SafeTensors::read_metadata(&bytes).map_err(broken)?;
    let (of_file, digest) = Origin::from_header(header.metadata().as_ref());
    if let Some(difference) = of_file.difference(origin) {
        return Err(bad(format!(
            "belongs to another run than the config.json beside it: its {difference}; restore the file and the \
             config.json of the same run"
        )));
    }
    let file = SafeTensors::deserialize(&bytes).map_err(broken)?;
    check_digest(&file, digest.as_deref(), path)?;
    file.iter()
        .map(|(name, view)| {
            let numbers = match view.dtype() {
                Dtype::F32 => {
                    let (numbers, _) = view.data().as_chunks();
                    TensorData::Single(numbers.iter().map(|&b| f32::from_le_bytes(b)).collect())
                }
                Dtype::F64 => {
                    let (numbers, _) = view.data().as_chunks();
                    TensorData::Double(numbers.iter().map(|&b| f64::from_le_bytes(b)).collect())
                }
                other => {
                    return Err(bad(format!("{name} has the type {other:?}, expected 32- or 64-bit floats")));
                }
            };
            Ok(StoredTensor { name: name.to_owned(), shape: view.shape().to_vec(), numbers })
        })
        .collect()
}
