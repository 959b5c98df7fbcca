//! The device that the network computes on. CUDA is opened if it is available.

use crate::StarError;
use crate::error::CudaFault;
use ddl_network::DeviceChoice;
#[cfg(target_os = "linux")]
use libloading::os::unix::{Library, RTLD_GLOBAL, RTLD_NOW};
use std::sync::OnceLock;

/// The libtorch version that this crate is built for.
pub const LIBTORCH_VERSION: &str = "2.11.0";

/// A device that has been opened and is available.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ComputeDevice(pub(crate) tch::Device);

impl ComputeDevice {
    /// Opens the device. Call it before any other use of libtorch: CUDA registers itself only if its library is loaded
    /// before the first tensor is made.
    ///
    /// # Errors
    /// [`StarError::Device`] when CUDA is requested and unavailable.
    pub fn open(choice: DeviceChoice) -> Result<Self, StarError> {
        match choice {
            DeviceChoice::Cpu => Ok(Self(tch::Device::Cpu)),
            DeviceChoice::Cuda => open_cuda().map(|()| Self(tch::Device::Cuda(0))),
            DeviceChoice::Auto => Ok(Self(match open_cuda() {
                Ok(()) => tch::Device::Cuda(0),
                Err(_) => tch::Device::Cpu,
            })),
        }
    }

    /// "cpu" or "cuda", as reports print it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self.0 {
            tch::Device::Cpu => "cpu",
            _ => "cuda",
        }
    }
}

/// Uses `threads` threads (at least one) for tensor operations in this process.
pub fn set_threads(threads: usize) {
    tch::set_num_threads(i32::try_from(threads.max(1)).unwrap_or(i32::MAX));
}

/// Limits tensor operations to one thread until it is dropped: small tensors do not gain from more threads.
#[derive(Debug)]
pub(crate) struct OneThread(i32);

impl OneThread {
    pub(crate) fn begin() -> Self {
        let before = Self(tch::get_num_threads());
        tch::set_num_threads(1);
        before
    }
}

impl Drop for OneThread {
    fn drop(&mut self) {
        tch::set_num_threads(self.0);
    }
}

fn open_cuda() -> Result<(), StarError> {
    static FOUND: OnceLock<Result<(), CudaFault>> = OnceLock::new();
    let found = FOUND.get_or_init(|| {
        load_cuda()?;
        if tch::Cuda::is_available() { Ok(()) } else { Err(CudaFault::NoCard) }
    });
    Ok(found.clone()?)
}

#[cfg(not(target_os = "linux"))]
fn load_cuda() -> Result<(), CudaFault> {
    Ok(())
}

/// `libtorch_cuda.so`, after CUDA was opened.
#[cfg(target_os = "linux")]
static CUDA: OnceLock<Library> = OnceLock::new();

#[cfg(target_os = "linux")]
pub(crate) fn cuda_library() -> Option<&'static Library> {
    CUDA.get()
}

#[cfg(target_os = "linux")]
fn load_cuda() -> Result<(), CudaFault> {
    // SAFETY: loading the library runs its initialisers, which register the CUDA backend with the libtorch in this
    // process. The library is the matching build (same release). It is opened once, before any tensor exists, and
    // never unloaded.
    #[allow(unsafe_code)]
    let library = unsafe { Library::open(Some("libtorch_cuda.so"), RTLD_NOW | RTLD_GLOBAL) };
    let library = library.map_err(|error| CudaFault::NoLibrary(error.to_string()))?;
    CUDA.get_or_init(|| library);
    Ok(())
}
