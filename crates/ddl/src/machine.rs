//! The machine a process computes on: device and threads.

use crate::{DdlError, Device};
use ddl_network::DeviceChoice;

/// Opens the device and sets the number of threads (all cores when `None`) of the kernels and of goal
/// search. libtorch itself uses one: what is left to it on the CPU are small tensors, over which several
/// threads would mostly wait for each other. Call it once, before anything else: CUDA can only be opened before the first
/// tensor is made.
///
/// # Errors
/// When the device cannot be had.
pub fn prepare(device: DeviceChoice, threads: Option<usize>) -> Result<(), DdlError> {
    Device::open(device)?;
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let threads = threads.unwrap_or(cores).max(1);
    #[cfg(feature = "torch")]
    ddl_star::set_threads(1);
    // A pool that was built earlier stays as it is: results do not depend on it.
    let _ = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build_global();
    Ok(())
}

/// "yes", or "no" and why.
#[must_use]
pub fn cuda_status() -> String {
    match Device::open(DeviceChoice::Cuda) {
        Ok(_) => "yes".into(),
        Err(error) => format!("no ({error})"),
    }
}
