//! Where networks compute, on how many threads, and the networks for it: kernels on the CPU, libtorch on CUDA.

use crate::error::DdlError;
use ddl_network::weights::{Layout, Weights};
use ddl_network::{
    DeviceChoice, ForecastWindows, MotionNetwork, NetworkError, ProposalConfig, ProposalNetwork,
    ProposeEnds, StarConfig,
};
use std::sync::Arc;

/// A device that was opened and is there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Device(Opened);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Opened {
    Cpu,
    #[cfg(feature = "torch")]
    Cuda(ddl_star::ComputeDevice),
}

impl Device {
    /// The CPU.
    pub const CPU: Self = Self(Opened::Cpu);

    /// Opens the device.
    ///
    /// # Errors
    /// When CUDA is asked for and cannot be had, or the program is built without libtorch.
    #[cfg(feature = "torch")]
    pub fn open(choice: DeviceChoice) -> Result<Self, DdlError> {
        let device = match choice {
            DeviceChoice::Cpu => return Ok(Self::CPU),
            DeviceChoice::Auto | DeviceChoice::Cuda => ddl_star::ComputeDevice::open(choice)?,
        };
        Ok(match device.name() {
            "cuda" => Self(Opened::Cuda(device)),
            _ => Self::CPU,
        })
    }

    /// Opens the device.
    ///
    /// # Errors
    /// When CUDA is asked for: the program is built without libtorch.
    #[cfg(not(feature = "torch"))]
    pub fn open(choice: DeviceChoice) -> Result<Self, DdlError> {
        match choice {
            DeviceChoice::Cpu | DeviceChoice::Auto => Ok(Self::CPU),
            DeviceChoice::Cuda => Err(DdlError::WithoutLibtorch { what: "CUDA" }),
        }
    }

    /// "cpu" or "cuda", as reports print it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self.0 {
            Opened::Cpu => "cpu",
            #[cfg(feature = "torch")]
            Opened::Cuda(_) => "cuda",
        }
    }

    /// The device as libtorch opens it.
    #[cfg(feature = "torch")]
    pub(crate) fn torch(self) -> Result<ddl_star::ComputeDevice, DdlError> {
        match self.0 {
            Opened::Cpu => Ok(ddl_star::ComputeDevice::open(DeviceChoice::Cpu)?),
            Opened::Cuda(device) => Ok(device),
        }
    }

    /// A forecasting network with the weights that `read` gives for its layout.
    ///
    /// # Errors
    /// When the configuration is out of range, or the weights cannot be read.
    pub(crate) fn forecasting(
        self,
        config: &StarConfig,
        read: impl FnOnce(&Arc<Layout>) -> Result<Weights, NetworkError>,
    ) -> Result<Box<dyn ForecastWindows>, DdlError> {
        match self.0 {
            Opened::Cpu => Ok(Box::new(MotionNetwork::reading(config.clone(), read)?)),
            #[cfg(feature = "torch")]
            Opened::Cuda(device) => {
                let network = ddl_star::TorchNetwork::new(config.clone(), 0, device)?;
                let weights = read(network.parameters().layout())?;
                network.parameters().set(&weights)?;
                Ok(network.into_forecaster())
            }
        }
    }

    /// A proposal network with the weights that `read` gives for its layout.
    ///
    /// # Errors
    /// When the configuration is out of range, or the weights cannot be read.
    pub(crate) fn proposing(
        self,
        config: &ProposalConfig,
        read: impl FnOnce(&Arc<Layout>) -> Result<Weights, NetworkError>,
    ) -> Result<Box<dyn ProposeEnds>, DdlError> {
        match self.0 {
            Opened::Cpu => Ok(Box::new(ProposalNetwork::reading(config.clone(), read)?)),
            #[cfg(feature = "torch")]
            Opened::Cuda(device) => {
                let network = ddl_star::TorchProposals::new(config.clone(), 0, device)?;
                let weights = read(network.parameters().layout())?;
                network.parameters().set(&weights)?;
                Ok(network.into_proposer())
            }
        }
    }
}

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
