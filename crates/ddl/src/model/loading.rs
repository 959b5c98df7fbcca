//! Loads a model from a run, a packed file or the program, and packs it.

use crate::device::Device;
use crate::error::DdlError;
use crate::goals::model::GoalModel;
use crate::goals::packed;
use crate::model::ddl::Ddl;
use crate::model::packing;
use crate::run::builtin_model::BuiltinModel;
use crate::run::config::RunConfig;
use crate::run::directory::{RunDirectory, write_atomically};
use crate::run::enough_weights;
use crate::run::model_source::ModelSource;
use ddl_core::Setting;
use ddl_network::weights::load_weights;
use ddl_network::{DeviceChoice, ForecastWindows};
use std::path::Path;

impl Ddl {
    /// Loads the finished run in the directory `path`, or the packed model in the file `path`.
    ///
    /// # Errors
    /// As [`Ddl::open`].
    pub fn load(path: &Path, device: DeviceChoice) -> Result<Self, DdlError> {
        Self::open(&ModelSource::at(path), device)
    }

    /// Loads a built-in model, which needs no file.
    ///
    /// # Errors
    /// When the device is unavailable.
    pub fn builtin(model: BuiltinModel, device: DeviceChoice) -> Result<Self, DdlError> {
        Self::open(&ModelSource::Builtin(model), device)
    }

    /// Loads a model from any source of models.
    ///
    /// # Errors
    /// When the run is missing or unfinished, one of its files is broken, or the device is unavailable.
    pub fn open(source: &ModelSource, device: DeviceChoice) -> Result<Self, DdlError> {
        Self::on(Device::open(device)?, source)
    }

    /// Loads a model whose networks libtorch computes on the CPU: the reference for the kernels. Its forecasts differ
    /// from those of [`Ddl::open`] by rounding.
    ///
    /// # Errors
    /// As [`Ddl::open`].
    #[cfg(feature = "torch")]
    pub fn reference(source: &ModelSource) -> Result<Self, DdlError> {
        Self::on(Device::libtorch_on_cpu()?, source)
    }

    fn on(device: Device, source: &ModelSource) -> Result<Self, DdlError> {
        match source.run() {
            Some(run) => Self::of_run(run.clone(), device),
            None => Self::of_packed(source, device),
        }
    }

    fn of_packed(source: &ModelSource, device: Device) -> Result<Self, DdlError> {
        let bytes = packed::bytes(source)?;
        let unpacked = packed::unpack(&bytes, source, device)?;
        let (goals, network) = GoalModel::of_packed(source, unpacked);
        Self::with(goals, device, network)
    }

    fn with(goals: GoalModel, device: Device, network: Box<dyn ForecastWindows>) -> Result<Self, DdlError> {
        Ok(Self { goals, device, parameters: network.copy_weights()?.numbers().len(), network })
    }

    fn of_run(run: RunDirectory, device: Device) -> Result<Self, DdlError> {
        let config = run.config()?;
        if !run.is_trained() {
            let problem = if run.has_goals(&config.goals) {
                format!(
                    "is not finished: its goals are trained, its network is not (no model.safetensors); start the same \
                     training again, without {}, to continue",
                    Setting::OnlyGoals
                )
            } else {
                "is not finished: it has no model.safetensors; start the same training again to continue".to_owned()
            };
            return Err(DdlError::run(run.path(), problem));
        }
        ModelSource::Run(run.clone()).check(&config)?;
        let network = load_network(&config, device, &run.model())?;
        Self::with(GoalModel::of_run(run, config, device)?, device, network)
    }

    /// The network with the weights of another epoch of its run.
    pub(crate) fn network_with(&self, weights: &Path) -> Result<Box<dyn ForecastWindows>, DdlError> {
        load_network(self.config(), self.device, weights)
    }

    /// Writes a forecast-only copy of the model into one small file, which [`Ddl::load`] reads. It holds the weights of
    /// both networks in half precision and the configuration of the run. The expert library, which is trajectory data,
    /// is left out: the packed model proposes all of its goals.
    ///
    /// # Errors
    /// When all goals come from the expert library, a weight is out of the range of half precision, or the file cannot
    /// be written.
    pub fn pack(&self, file: &Path) -> Result<(), DdlError> {
        write_atomically(file, &packing::pack(&*self.network, &self.goals)?)
    }
}

fn load_network(config: &RunConfig, device: Device, weights: &Path) -> Result<Box<dyn ForecastWindows>, DdlError> {
    enough_weights::require(weights, config.star.min_weight_count())?;
    device.forecasting(&config.star, |layout| load_weights(layout, &config.network_origin(), weights))
}

impl ModelSource {
    /// The configuration of the model. This is cheap: it does not make the networks.
    ///
    /// # Errors
    /// When there is no run, or the file is not a complete packed model.
    pub fn config(&self) -> Result<RunConfig, DdlError> {
        match self {
            Self::Run(run) => run.config(),
            Self::Packed(_) | Self::Builtin(_) => packed::config(&packed::bytes(self)?, self),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ddl_data::Convention;
    use ddl_network::Variant;

    /// Keeps the repository and web pages with a model small.
    const MOST_BYTES: usize = 2_000_000;

    #[test]
    fn each_model_is_of_its_fold_small_and_without_tracks() {
        for model in BuiltinModel::ALL {
            let config = ModelSource::Builtin(model).config().unwrap();
            if BuiltinModel::OF_FOLDS.contains(&model) {
                assert_eq!(config.data.fold, model.name());
                assert_eq!(config.data.convention, Convention::Star);
            } else {
                assert_eq!(config.data.convention, Convention::Own);
            }
            assert_eq!(config.star.variant, Variant::Full);
            assert!(model.bytes().len() <= MOST_BYTES, "{model}");
            let loaded = Ddl::builtin(model, DeviceChoice::Cpu).unwrap();
            assert_eq!(loaded.config(), &config);
            assert!(loaded.goal_model().estimator().is_none());
            // Two bytes for each weight, the hashes, names and configuration: a file of this size holds no tracks.
            let numbers = loaded.parameter_count() + loaded.goal_model().parameter_count();
            let hashes = loaded.goal_model().fingerprints().to_bytes().len();
            assert!(model.bytes().len() < 2 * numbers + hashes + 20_000, "{model}");
            assert_eq!(model.name().parse::<BuiltinModel>().unwrap(), model);
        }
        let error = "corridor".parse::<BuiltinModel>().unwrap_err().to_string();
        assert!(error.contains("corridor") && error.contains("zara2"), "{error}");
    }

    #[test]
    fn the_default_has_seen_the_most_pedestrians() {
        let seen = |model: &BuiltinModel| ModelSource::Builtin(*model).config().unwrap().data.pedestrians;
        assert_eq!(BuiltinModel::ALL.into_iter().max_by_key(seen), Some(BuiltinModel::default()));
    }
}
