//! The device and the number of threads that networks compute with. Networks run as kernels on the CPU and through
//! libtorch on CUDA.

use crate::error::DdlError;
use ddl_network::weights::{Layout, Weights};
use ddl_network::{
    DeviceChoice, ForecastWindows, MotionNetwork, NetworkError, ProposalConfig, ProposalNetwork, ProposeEndpoints,
    StarConfig,
};
use std::sync::Arc;

/// Most threads that can be asked for: more than a machine has cores only take time to start.
const MOST_THREADS: usize = 1024;

/// A device that has been opened and is available.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Device {
    Cpu,
    #[cfg(feature = "torch")]
    Torch(ddl_star::ComputeDevice),
}

impl Device {
    /// Opens the device.
    ///
    /// # Errors
    /// When CUDA is requested and unavailable, or the program is built without libtorch.
    pub(crate) fn open(choice: DeviceChoice) -> Result<Self, DdlError> {
        #[cfg(feature = "torch")]
        if choice != DeviceChoice::Cpu {
            let device = ddl_star::ComputeDevice::open(choice)?;
            if device.name() == "cuda" {
                return Ok(Self::Torch(device));
            }
        }
        #[cfg(not(feature = "torch"))]
        if choice == DeviceChoice::Cuda {
            return Err(DdlError::WithoutLibtorch { what: "CUDA" });
        }
        Ok(Self::Cpu)
    }

    /// libtorch on the CPU: the reference for the kernels.
    ///
    /// # Errors
    /// When libtorch cannot compute.
    #[cfg(feature = "torch")]
    pub(crate) fn libtorch_on_cpu() -> Result<Self, DdlError> {
        Ok(Self::Torch(ddl_star::ComputeDevice::open(DeviceChoice::Cpu)?))
    }

    /// "cpu" or "cuda", as reports print it.
    #[must_use]
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Cpu => "cpu",
            #[cfg(feature = "torch")]
            Self::Torch(device) => device.name(),
        }
    }

    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::Cpu => "cpu",
            #[cfg(feature = "torch")]
            Self::Torch(device) if device.name() == "cpu" => "cpu, libtorch",
            #[cfg(feature = "torch")]
            Self::Torch(_) => "cuda",
        }
    }

    #[cfg(feature = "torch")]
    pub(crate) fn torch(self) -> Result<ddl_star::ComputeDevice, DdlError> {
        match self {
            Self::Cpu => Ok(ddl_star::ComputeDevice::open(DeviceChoice::Cpu)?),
            Self::Torch(device) => Ok(device),
        }
    }

    pub(crate) fn forecasting(
        self,
        config: &StarConfig,
        read: impl FnOnce(&Arc<Layout>) -> Result<Weights, NetworkError>,
    ) -> Result<Box<dyn ForecastWindows>, DdlError> {
        match self {
            Self::Cpu => Ok(Box::new(MotionNetwork::reading(config.clone(), read)?)),
            #[cfg(feature = "torch")]
            Self::Torch(device) => {
                let network = ddl_star::TorchNetwork::new(config.clone(), 0, device)?;
                let weights = read(network.parameters().layout())?;
                network.parameters().set(&weights)?;
                Ok(network.into_forecaster())
            }
        }
    }

    pub(crate) fn proposing(
        self,
        config: &ProposalConfig,
        read: impl FnOnce(&Arc<Layout>) -> Result<Weights, NetworkError>,
    ) -> Result<Box<dyn ProposeEndpoints>, DdlError> {
        match self {
            Self::Cpu => Ok(Box::new(ProposalNetwork::reading(config.clone(), read)?)),
            #[cfg(feature = "torch")]
            Self::Torch(device) => {
                let network = ddl_star::TorchProposals::new(config.clone(), 0, device)?;
                let weights = read(network.parameters().layout())?;
                network.parameters().set(&weights)?;
                Ok(network.into_proposer())
            }
        }
    }
}

/// Opens the device and sets the number of threads of the kernels and of goal search (`None`: all cores). libtorch
/// itself uses one thread. Call it once, before anything else: CUDA can be opened only before the first tensor is made.
///
/// # Errors
/// When the device is unavailable; more than 1,024 threads.
pub fn prepare(device: DeviceChoice, threads: Option<usize>) -> Result<(), DdlError> {
    Device::open(device)?;
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let pool = pool_of(threads.unwrap_or(cores).max(1))?;
    #[cfg(feature = "torch")]
    ddl_star::set_threads(1);
    // An existing thread pool is kept: results do not depend on the number of threads.
    let _ = pool.build_global();
    Ok(())
}

/// Threads of their own for the kernels and goal search, for those who call `install` on them; 0: one for each core.
///
/// # Errors
/// More than 1,024, or the system refuses.
pub fn thread_pool(threads: usize) -> Result<rayon::ThreadPool, DdlError> {
    Ok(pool_of(threads)?.build()?)
}

fn pool_of(threads: usize) -> Result<rayon::ThreadPoolBuilder, DdlError> {
    if threads > MOST_THREADS {
        return Err(DdlError::Threads(threads));
    }
    Ok(rayon::ThreadPoolBuilder::new().num_threads(threads).start_handler(|_| ddl_network::prepare_thread()))
}

/// "yes", or "no" with the reason.
#[must_use]
pub fn cuda_status() -> String {
    match Device::open(DeviceChoice::Cuda) {
        Ok(_) => "yes".into(),
        Err(error) => format!("no ({error})"),
    }
}
